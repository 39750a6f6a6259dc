#include "sim/front_ends/terminal_view/face_text.hpp"

#include <chrono>
#include <cstdint>

#include "sim/line_monitor/module_view/terminals.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

// Widths in columns.
constexpr std::size_t kMargin = 3;
constexpr std::size_t kDesignation = 12;
constexpr std::size_t kName = 8;
constexpr std::size_t kInForce = 26;
constexpr std::size_t kLed = 15;
constexpr std::size_t kTerminal = 8;
constexpr std::size_t kChannel = 3;

std::string padded(std::string text, std::size_t columns) {
  text.append(text.size() < columns ? columns - text.size() : 0, ' ');
  return text;
}

std::string indented(const std::string& text) { return std::string(kMargin, ' ') + text; }

std::string tenths(VirtualTime time) {
  const auto count = std::chrono::duration_cast<std::chrono::milliseconds>(time).count() / 100;
  return std::to_string(count / 10) + "." + std::to_string(count % 10) + " s";
}

std::string supply_text(const Plate& plate) {
  if (plate.powered) {
    return "power on";
  }
  return plate.switched_on ? "no power" : "power off";
}

/// Returns the settings that a master requires to reach the module. Returns `starting` if the module is
/// powered but has not started up, and an empty string if the module has no power.
std::string in_force_text(const Plate& plate) {
  if (!plate.listening) {
    return plate.powered ? "starting" : "";
  }
  const bool ascii = plate.protocol == Protocol::Ascii;
  return hex_byte_text(plate.address) + (ascii ? " DCON " : " Modbus RTU ") +
         std::to_string(plate.mode.baud) + " " + line_format_text(plate.mode.format) +
         (ascii && plate.checksum ? " CHK" : "");
}

std::string guard_text(const HostWatchdogState& guard) {
  if (guard.timed_out) {
    return "timed out";
  }
  return guard.enabled ? tenths(std::chrono::milliseconds(100 * guard.timeout)) : "off";
}

std::string values_text(const Face& face) {
  const Settings& stored = face.stored.settings;
  return "power-on " + hex_word_text(stored.power_on_value) + ", safe " + hex_word_text(stored.safe_value);
}

std::string counters_text(const Model& model, const InputRecords& gathered) {
  std::string text = "counters";
  for (unsigned channel = 0; channel < model.inputs; ++channel) {
    text += " " + std::to_string(gathered.counters[channel]);
  }
  return text;
}

/// Returns one bit for each input, in two hex digits, or in four if the model has more than eight inputs.
std::string inputs_text(const Model& model, std::uint16_t inputs) {
  constexpr unsigned kInputsOfAByte = 8;
  return model.inputs > kInputsOfAByte ? hex_word_text(inputs) : hex_byte_text(inputs);
}

std::string latches_text(const Model& model, const InputRecords& gathered) {
  return "latched high " + inputs_text(model, gathered.latched_high) + ", low " +
         inputs_text(model, gathered.latched_low);
}

std::string head(std::size_t number, const SimulatedModule& module, const Face& face, const Lamps& lamps) {
  const Plate& plate = face.plate;
  const bool flashes = plate.led == Led::HostTimeout || plate.led == Led::SettingsUnreadable;
  const std::string led = flashes ? "flashing" : std::string(led_text(plate.led));
  return padded(std::to_string(number), kMargin) +
         padded(std::string(module.model().designation), kDesignation) +
         padded(name_text(face.stored.settings), kName) + padded(in_force_text(plate), kInForce) + "LED " +
         (module.led_lit() ? lamps.on : lamps.off) + padded(" " + led, kLed - std::string("LED *").size()) +
         supply_text(plate) + (plate.init ? ", INIT*" : "");
}

/// Adds a row with the numbers of the terminals and a row with their LEDs.
void add_channels(std::vector<std::string>& lines, const std::string& first_terminal, unsigned channels,
                  std::uint16_t states, const Lamps& lamps) {
  const std::size_t number = first_terminal.find_first_of("0123456789");
  const auto first = static_cast<unsigned>(std::stoul(first_terminal.substr(number)));
  std::string labels = indented(padded(first_terminal.substr(0, number), kTerminal));
  std::string leds = indented(std::string(kTerminal, ' '));
  for (unsigned channel = 0; channel < channels; ++channel) {
    const std::string after(channel + 1 == channels ? 0 : kChannel - 1, ' ');
    const std::string label = std::to_string(first + channel);
    labels += after.empty() ? label : padded(label, kChannel);
    leds += ((states >> channel & 1U) != 0 ? lamps.on : lamps.off) + after;
  }
  lines.push_back(labels);
  lines.push_back(leds);
}

std::string guard_line(const HostWatchdogState& guard, VirtualTime now) {
  std::string text = "host watchdog " + guard_text(guard);
  if (guard.expires) {
    text += ", " + tenths(*guard.expires > now ? *guard.expires - now : VirtualTime(0)) + " left";
  }
  return text;
}

}  // namespace

std::vector<std::string> face_text(std::size_t number, const SimulatedModule& module, VirtualTime now,
                                   const Lamps& lamps) {
  const Face face = face_of(module, now);
  const Model& model = module.model();
  std::vector<std::string> lines{head(number, module, face, lamps)};
  if (model.outputs != 0) {
    add_channels(lines, output_terminal(model, 0), model.outputs, face.plate.outputs, lamps);
    lines.push_back(indented(values_text(face)));
  }
  if (model.inputs != 0) {
    add_channels(lines, input_terminal(0), model.inputs, face.plate.inputs, lamps);
  }
  if (!face.plate.listening) {
    return lines;
  }
  if (model.inputs != 0) {
    lines.push_back(indented(counters_text(model, face.gathered)));
    lines.push_back(indented(latches_text(model, face.gathered)));
  }
  lines.push_back(indented(guard_line(face.guard, now)));
  return lines;
}

std::vector<std::string> changes_text(const Model& model, const Face* before, const Face& now) {
  std::vector<std::string> changes;
  const auto add = [&](const auto& text_of, bool there_is_one = true) {
    const std::string text = text_of(now);
    if (there_is_one && !text.empty() && (before == nullptr || text != text_of(*before))) {
      changes.push_back(text);
    }
  };
  const bool gathers = model.inputs != 0 && now.plate.listening;
  add([](const Face& face) { return supply_text(face.plate); });
  add([](const Face& face) { return std::string(face.plate.init ? "INIT* on" : "INIT* off"); });
  add([](const Face& face) { return in_force_text(face.plate); });
  add([](const Face& face) { return "LED " + std::string(led_text(face.plate.led)); });
  add([](const Face& face) { return "outputs " + hex_word_text(face.plate.outputs); }, model.outputs != 0);
  add([](const Face& face) { return values_text(face); }, model.outputs != 0);
  add([&](const Face& face) { return "inputs " + inputs_text(model, face.plate.inputs); }, model.inputs != 0);
  add([&](const Face& face) { return counters_text(model, face.gathered); }, gathers);
  add([&](const Face& face) { return latches_text(model, face.gathered); }, gathers);
  add([](const Face& face) { return "host watchdog " + guard_text(face.guard); }, now.plate.listening);
  return changes;
}

}  // namespace ex9000::sim
