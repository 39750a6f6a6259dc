#include "tests/world/steps.hpp"

#include <type_traits>

#include "tests/oracles/reference/hexadecimal.hpp"

namespace ex9000::world {

namespace {

std::string number(std::size_t index) { return std::to_string(index + 1); }
const char* on_off(bool on) { return on ? " on" : " off"; }

struct Text {
  std::string operator()(const Send& send) const {
    std::string text = "master " + number(send.master) + " sends at " + std::to_string(send.mode.baud) + " " +
                       reference::name_of(send.mode.format) + " bytes";
    for (const std::uint8_t byte : send.bytes) {
      text += " " + reference::hex(byte, 2);
    }
    return text;
  }
  std::string operator()(const Wait& wait) const {
    return "wait " + std::to_string(wait.time.count()) + " ns";
  }
  std::string operator()(const Power& power) const {
    return number(power.module) + " power" + on_off(power.on);
  }
  std::string operator()(const Reset& reset) const { return number(reset.module) + " reset"; }
  std::string operator()(const Init& init) const {
    return number(init.module) + " init" + on_off(init.asserted);
  }
  std::string operator()(const Input& input) const {
    return number(input.module) + " input " + std::to_string(input.channel) + on_off(input.level);
  }
  std::string operator()(const Pulse& pulse) const {
    return number(pulse.module) + " pulse " + std::to_string(pulse.channel) + " x" +
           std::to_string(pulse.count);
  }
  std::string operator()(const Hang& hang) const {
    return number(hang.module) + " hang for " + std::to_string(hang.time.count()) + " ns";
  }
  std::string operator()(const TickStops& tick) const { return number(tick.module) + " tick stops"; }
  std::string operator()(const MemoryFails& fails) const {
    return number(fails.module) + " memory fails" + on_off(fails.on);
  }
  std::string operator()(const SlotsFail& fails) const {
    return number(fails.module) + " slots fail" + on_off(fails.on);
  }
  std::string operator()(const BadImages& bad) const {
    return number(bad.module) + " bad images" + on_off(bad.on);
  }
  std::string operator()(const SpoilReply& spoil) const {
    return number(spoil.module) + " next reply late by " + std::to_string(spoil.late_by.count()) + " ns";
  }
  std::string operator()(const Noise& noise) const {
    return "noise " + std::to_string(noise.rates.flipped_bit) + " " +
           std::to_string(noise.rates.lost_character) + " " + std::to_string(noise.rates.stray_character) +
           " " + std::to_string(noise.rates.stray_zero);
  }
};

}  // namespace

std::string text_of(const Step& step) { return std::visit(Text{}, step); }

std::size_t* module_of(Step& step) {
  return std::visit(
      [](auto& each) -> std::size_t* {
        using Kind = std::decay_t<decltype(each)>;
        if constexpr (std::is_same_v<Kind, Send> || std::is_same_v<Kind, Wait> ||
                      std::is_same_v<Kind, Noise>) {
          return nullptr;
        } else {
          return &each.module;
        }
      },
      step);
}

std::string text_of(const Setup& setup) {
  std::string text = "the line begins at " + std::to_string(setup.begins.count()) + " ns\n";
  for (const Member& member : setup.members) {
    const reference::Stored& stored = member.stored;
    const auto add = [&text](const char* name, unsigned value) {
      text += std::string(", ") + name + " " + reference::hex(value, 2);
    };
    text += std::string(member.row->designation) + (member.blank ? ", blank memory" : "") +
            (stored.modbus ? ", Modbus" : ", ASCII") + (stored.timed_out ? ", timeout status" : "");
    add("address", stored.address);
    add("CC", stored.baud_code);
    add("FF", stored.format);
    add("power-on", stored.power_on);
    add("safe", stored.safe);
    add("watchdog", stored.enabled ? 1 : 0);
    add("timeout", stored.timeout);
    add("0251", stored.restarted_by_requests);
    add("delay", stored.delay);
    add("inversion", stored.inversion);
    text += ", serial number " + reference::hex(stored.serial_number, 8) + " of the board " +
            reference::hex(member.serial_number, 8);
    for (unsigned channel = 0; channel < member.row->inputs; ++channel) {
      text += (channel == 0 ? ", filters " : " ") + std::to_string(stored.filters[channel]);
    }
    text += "\n";
  }
  return text;
}

}  // namespace ex9000::world
