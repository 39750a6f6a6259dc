// What the command line says of one module: MODEL[@ADDR][,KEY=VALUE]...
#pragma once

#include <string>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000::sim {

struct ModuleSpec {
  const Model* model = nullptr;
  Settings settings;  ///< stored before power-on
  bool init_asserted = false;

  /// Bits per second that it listens at after power-on.
  [[nodiscard]] std::uint32_t baud() const;
  /// The address that it answers to after power-on.
  [[nodiscard]] std::uint8_t address() const;
  [[nodiscard]] bool speaks_ascii() const { return init_asserted || settings.protocol == Protocol::Ascii; }
};

/// Throws std::invalid_argument, one line that names what is wrong and what would be right.
ModuleSpec parse_module_spec(const std::string& text);

/// Two upper-case digits.
std::string hex_byte_text(unsigned value);

}  // namespace ex9000::sim
