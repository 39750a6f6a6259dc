// Starts a module with arbitrary EEPROM content. The module must start, and must then store settings and load
// them after a reset.
//
// Byte 0 of the input selects the model. The bits of byte 1 have these meanings:
//
//     bit 2      INIT* is connected to GND
//     bit 3      the memory does not acknowledge until the module has started
//     bit 4, 5   the target corrects the layout, the length and the check of the first (bit 4) or the second
//                (bit 5) copy
//
// The following bytes are the content of the memory from address 0. Memory after these bytes is erased.
#include <algorithm>
#include <array>
#include <cstring>
#include <initializer_list>
#include <string>

#include "tests/fuzz/session.hpp"
#include "tests/support/stored_settings.hpp"

namespace ex9000::fuzz {
namespace {

constexpr std::size_t kHeader = 2;

/// The expected state of the module after its start.
struct Expected {
  Settings settings;
  bool unreadable = false;
};

Expected expected_of(const Model& model, const std::uint8_t* memory, bool answers) {
  if (!answers || place_that_counts(model, memory) == kStoredMemory) {
    const bool blank = std::all_of(kStoredPlaces.begin(), kStoredPlaces.end(), [&](std::size_t place) {
      return StoredCopy(model, memory, place).is_blank();
    });
    return {Settings::factory(model), !answers || !blank};
  }
  return {settings_from(model, memory), false};
}

class Trial {
 public:
  Trial(const Model& model, std::uint8_t flags, const std::uint8_t* contents, std::size_t size)
      : model_(model), session_(model, false) {
    auto& memory = session_.around().memory;
    std::copy_n(contents, std::min(size, memory.size()), memory.begin());
    constexpr std::array<std::uint8_t, kStoredPlaces.size()> kSealed{0x10, 0x20};
    for (std::size_t place = 0; place < kStoredPlaces.size(); ++place) {
      if ((flags & kSealed[place]) != 0) {
        StoredCopy::seal(model, memory.data(), kStoredPlaces[place]);
      }
    }
    session_.around().init_asserted = (flags & 4U) != 0;
    session_.around().memory_answers = (flags & 8U) == 0;
  }

  void run() {
    const Expected expected =
        expected_of(model_, session_.around().memory.data(), session_.around().memory_answers);
    session_.reset();
    come_up_with(expected.settings);
    require(session_.module().module().settings_unreadable() == expected.unreadable,
            "unreadable settings are distinguished from an erased memory");
    session_.around().memory_answers = true;
    tells(expected.settings);
    store_something();
    wait_for_leftovers();
    const Settings before = state().settings;
    session_.reset();
    come_up_with(before);
    tells(before);
  }

 private:
  const State& state() { return session_.module().module().state(); }

  /// Waits until no store is pending. The host watchdog can expire at any time, and the module then stores
  /// that the watchdog is disabled and that the timeout status is set. If the settings change during the
  /// wait, waits again.
  void wait_for_leftovers() {
    constexpr Microseconds kLongest = 1500 * kMillisecond;
    Settings before;
    do {
      before = state().settings;
      session_.wait(kLongest);
    } while (state().settings != before);
  }

  void come_up_with(const Settings& settings) {
    const bool init = session_.around().init_asserted;
    const InForce& in_force = session_.in_force();
    // The host watchdog cannot have expired yet: its shortest timeout is 0.1 s, and `reset` returns earlier.
    require(state().settings == settings,
            "the module uses the newest valid copy, or else the factory settings");
    require(state().outputs == (settings.timeout_status ? settings.safe_value : settings.power_on_value),
            "outputs start with the power-on value, or with the safe value after a timeout");
    require(in_force.init_mode == init && in_force.address == (init ? 0 : settings.address) &&
                in_force.baud_code == (init ? 0x06 : settings.baud_code) &&
                in_force.protocol == (init ? Protocol::Ascii : settings.protocol) &&
                in_force.checksum == (!init && (settings.format & 0x40U) != 0),
            "the stored settings or, in INIT mode, the settings of INIT mode are in force");
  }

  Bytes ask(std::string_view command) {
    const std::uint8_t address = session_.in_force().address;
    text_.assign(command);
    text_[1] = static_cast<char>(upper_hex(address / 16U));
    text_[2] = static_cast<char>(upper_hex(address));
    return session_.ask({reinterpret_cast<const std::uint8_t*>(text_.data()), text_.size()});
  }
  Bytes ask(std::initializer_list<std::uint8_t> request) {
    return session_.ask({request.begin(), request.size()});
  }

  void tells(const Settings& settings) {
    if (session_.speaks_modbus()) {
      const Bytes reply = ask({settings.address, 0x03, 0x01, 0xE4, 0x00, 0x02});
      require(reply.size == 7 && reply.word(3) == settings.address && reply.word(5) == settings.baud_code,
              "the module returns the stored address and baud rate");
      return;
    }
    const Bytes configuration = ask("$..2");
    require(configuration.size == 9 && are_digits_of(configuration.data + 1, settings.address) &&
                are_digits_of(configuration.data + 5, settings.baud_code) &&
                are_digits_of(configuration.data + 7, settings.format),
            "the module returns the stored configuration");
    const Bytes name = ask("$..M").from(3);
    require(Name(name) == settings.name, "the module returns the stored name");
  }

  void store_something() {
    if (session_.speaks_modbus()) {
      const auto next = static_cast<std::uint8_t>(state().settings.address % 247 + 1);
      const std::uint8_t own = session_.in_force().address;
      require(ask({own, 0x06, 0x01, 0xE4, 0x00, next}).size == 6 && state().settings.address == next,
              "an address is stored");
      return;
    }
    const bool is_pump = state().settings.name == Name(std::string_view("pump"));
    const std::string_view name = is_pump ? "fan" : "pump";
    require(ask("~..O" + std::string(name)).size == 3 && state().settings.name == Name(name),
            "a name is stored");
  }
  Bytes ask(const std::string& command) { return ask(std::string_view(command)); }
  Bytes ask(const char* command) { return ask(std::string_view(command)); }

  const Model& model_;
  Session session_;
  std::string text_;
};

}  // namespace
}  // namespace ex9000::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ex9000::fuzz;
  if (size >= kHeader) {
    const ex9000::Model& model = ex9000::kModels[data[0] % std::size(ex9000::kModels)];
    Trial(model, data[1], data + kHeader, size - kHeader).run();
  }
  return 0;
}
