// The models, one table row each. To add one: .github/CONTRIBUTING.md. No protocol code uses a designation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace ex9000 {

/// As `$AAF` and object 02 of function 2B return it, in the form `Dnn.nn` (manuals 2.8). Register 0x0300
/// contains its four digits in BCD.
constexpr std::string_view kFirmwareVersion = "D01.00";

/// The four digits of `Dnn.nn`.
constexpr std::uint16_t version_in_bcd(std::string_view version = kFirmwareVersion) {
  unsigned digits = 0;
  for (const char character : version) {
    if (character >= '0' && character <= '9') {
      digits = digits << 4U | static_cast<unsigned>(character - '0');
    }
  }
  return static_cast<std::uint16_t>(digits);
}

/// What `~AA0`, the host watchdog's status, can return (manuals 2.16; EX9052D 2.18).
enum class StatusStyle : std::uint8_t {
  TimeoutOnly,       ///< 00, 04
  EnableAndTimeout,  ///< 00, 80, 84
};

/// Not for protocol code: the simulator labels the terminals with it.
enum class OutputKind : std::uint8_t { None, OpenCollector, Relay, PhotoMos };

/// Where the user ties INIT* to GND; the simulator shows it. Older modules have a terminal, newer ones a
/// slide switch at the rear (manuals 1.4). The first pages of two manuals name the models with a switch.
enum class InitInput : std::uint8_t { Terminal, RearSwitch };

struct Model {
  std::string_view designation;  ///< as on the label, e.g. "EX9042D-M"
  std::uint8_t inputs;           ///< number of channels, 0 to 16; more than 8 only without outputs
  std::uint8_t outputs;          ///< number of channels, 0 to 16; more than 8 only without inputs
  std::uint16_t modbus_code;     ///< the module's code in Modbus, e.g. 0x9042; 0: the model speaks ASCII only
  StatusStyle status_style;
  std::string_view factory_name;  ///< factory setting of the name, which `$AAM` returns
  std::uint8_t longest_name;      ///< longest name that `~AAO` accepts, in characters
  std::string_view description;   ///< object 04 of Modbus function 2B; also shown to users
  OutputKind output_kind;
  InitInput init_input = InitInput::Terminal;

  /// A character of the designation without `EX` and `-`, e.g. of "9042DM"; 0 after its end.
  [[nodiscard]] constexpr std::uint8_t short_designation(unsigned index) const {
    constexpr std::size_t kFamily = 2;
    for (const char character : designation.substr(kFamily)) {
      if (character != '-' && index-- == 0) {
        return static_cast<std::uint8_t>(character);
      }
    }
    return 0;
  }
  [[nodiscard]] constexpr bool speaks_modbus() const { return modbus_code != 0; }
  [[nodiscard]] constexpr bool has_inputs() const { return inputs != 0; }
  [[nodiscard]] constexpr bool has_outputs() const { return outputs != 0; }
  /// Bit n is set for each existing channel n.
  [[nodiscard]] constexpr std::uint16_t output_mask() const {
    return static_cast<std::uint16_t>((1UL << outputs) - 1U);
  }
  [[nodiscard]] constexpr std::uint16_t input_mask() const {
    return static_cast<std::uint16_t>((1UL << inputs) - 1U);
  }
};

constexpr unsigned kMaxInputs = 16;
constexpr unsigned kMaxOutputs = 16;
constexpr unsigned kMaxNameLength = 7;

inline constexpr Model kModels[] = {
    // The modules of the four manuals.
    {"EX9042D", 0, 13, 0, StatusStyle::EnableAndTimeout, "9042D", 6, "13 open-collector outputs",
     OutputKind::OpenCollector},
    {"EX9042D-M", 0, 13, 0x9042, StatusStyle::EnableAndTimeout, "9042M", 6, "13 open-collector outputs",
     OutputKind::OpenCollector},
    {"EX9043D", 0, 16, 0, StatusStyle::TimeoutOnly, "9043D", 6, "16 open-collector outputs",
     OutputKind::OpenCollector},
    {"EX9043D-M", 0, 16, 0x9043, StatusStyle::TimeoutOnly, "9043M", 6, "16 open-collector outputs",
     OutputKind::OpenCollector, InitInput::RearSwitch},
    {"EX9052D", 8, 0, 0, StatusStyle::EnableAndTimeout, "9052", 6, "8 inputs with latches and counters",
     OutputKind::None},
    {"EX9052D-M", 8, 0, 0x9052, StatusStyle::EnableAndTimeout, "9052M", 6,
     "8 inputs with latches and counters", OutputKind::None, InitInput::RearSwitch},
    {"EX9068D-M", 0, 8, 0x9068, StatusStyle::TimeoutOnly, "9068D-M", 7, "8 relay outputs", OutputKind::Relay},
    {"EX9068AD-M", 0, 8, 0x9068, StatusStyle::TimeoutOnly, "9068D-M", 7, "8 PhotoMOS outputs",
     OutputKind::PhotoMos},
    // Other models. Their outputs are from the tables 2.3 and 2.11 of the manuals, and their inputs are
    // those of the ICP DAS I-70xx modules with the same last two digits. The Modbus map of the EX9060D-M is
    // from its manual. The maps of the EX9044D-M and EX9053D-M are inferred (wire.md section 1).
    {"EX9044D", 4, 8, 0, StatusStyle::TimeoutOnly, "9044", 6, "4 inputs, 8 open-collector outputs",
     OutputKind::OpenCollector},
    {"EX9044D-M", 4, 8, 0x9044, StatusStyle::TimeoutOnly, "9044M", 6, "4 inputs, 8 open-collector outputs",
     OutputKind::OpenCollector},
    {"EX9050D", 7, 8, 0, StatusStyle::TimeoutOnly, "9050", 6, "7 inputs, 8 open-collector outputs",
     OutputKind::OpenCollector},
    {"EX9053D", 16, 0, 0, StatusStyle::EnableAndTimeout, "9053", 6, "16 inputs with latches and counters",
     OutputKind::None},
    {"EX9053D-M", 16, 0, 0x9053, StatusStyle::EnableAndTimeout, "9053M", 6,
     "16 inputs with latches and counters", OutputKind::None},
    {"EX9055D", 8, 8, 0, StatusStyle::TimeoutOnly, "9055", 6, "8 inputs, 8 open-collector outputs",
     OutputKind::OpenCollector},
    {"EX9060D", 4, 4, 0, StatusStyle::TimeoutOnly, "9060", 6, "4 inputs, 4 relay outputs", OutputKind::Relay},
    {"EX9060D-M", 4, 4, 0x9060, StatusStyle::TimeoutOnly, "9060M", 6, "4 inputs, 4 relay outputs",
     OutputKind::Relay},
    {"EX9063D", 8, 3, 0, StatusStyle::TimeoutOnly, "9063", 6, "8 inputs, 3 relay outputs", OutputKind::Relay},
    {"EX9065D", 4, 5, 0, StatusStyle::TimeoutOnly, "9065", 6, "4 inputs, 5 relay outputs", OutputKind::Relay},
    {"EX9066D", 0, 7, 0, StatusStyle::TimeoutOnly, "9066", 6, "7 PhotoMOS outputs", OutputKind::PhotoMos},
    {"EX9067D", 0, 7, 0, StatusStyle::TimeoutOnly, "9067", 6, "7 relay outputs", OutputKind::Relay},
    {"EX9068D", 0, 8, 0, StatusStyle::TimeoutOnly, "9068", 6, "8 relay outputs", OutputKind::Relay},
};

/// Null if there is none.
constexpr const Model* find_model(std::string_view designation) {
  for (const Model& model : kModels) {
    if (model.designation == designation) {
      return &model;
    }
  }
  return nullptr;
}

/// What a DCON command, a Modbus function or a register-map row requires of a model.
enum class Needs : std::uint8_t { Nothing, Outputs, Inputs, Modbus, ImageSlots };

constexpr bool meets(const Model& model, Needs needs) {
  switch (needs) {  // not covered: the enumeration has no other value
    case Needs::Outputs:
      return model.has_outputs();
    case Needs::Inputs:
      return model.has_inputs();
    case Needs::Modbus:
    case Needs::ImageSlots:  // these are the board's; built.hpp knows whether it has them
      return model.speaks_modbus();
    case Needs::Nothing:
      break;
  }
  return true;
}

}  // namespace ex9000
