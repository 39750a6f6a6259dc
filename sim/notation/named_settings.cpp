#include "sim/notation/named_settings.hpp"

#include <algorithm>
#include <string_view>

#include "firmware/model/baud.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

Protocol parse_protocol(const Model& model, const std::string& value) {
  if (!parse_choice(value, "modbus", "ascii")) {
    return Protocol::Ascii;
  }
  if (!model.speaks_modbus()) {
    fail("'modbus': the " + std::string(model.designation) + " speaks ASCII only; expected ascii");
  }
  return Protocol::ModbusRtu;
}

std::uint8_t with_rate(std::uint8_t baud_code, std::uint32_t rate) {
  const auto* const found = std::find(kBaudRates.begin(), kBaudRates.end(), rate);
  const auto code = static_cast<std::uint8_t>(kFirstBaudCode + (found - kBaudRates.begin()));
  return with_line_format(code, line_format(baud_code));
}

Name parse_name(const Model& model, const std::string& value) {
  const Name name{std::string_view(value)};
  if (value.size() > model.longest_name || !name.is_possible(model.longest_name)) {
    fail("'" + value + "': expected 1 to " + std::to_string(model.longest_name) +
         " printable ASCII characters for the " + std::string(model.designation));
  }
  return name;
}

void set_format(Settings& settings, std::uint8_t bit, bool on) {
  settings.format = static_cast<std::uint8_t>(on ? settings.format | bit : settings.format & ~bit);
}

}  // namespace

bool set_by_name(Settings& settings, const Model& model, const std::string& key, const std::string& value) {
  if (key == "protocol") {
    settings.protocol = parse_protocol(model, value);
  } else if (key == "baud") {
    settings.baud_code = with_rate(settings.baud_code, parse_baud_rate(value));
  } else if (key == "format") {
    settings.baud_code = with_line_format(settings.baud_code, parse_line_format(value));
  } else if (key == "checksum") {
    set_format(settings, kFormatChecksum, parse_on_off(value));
  } else if (key == "edge") {
    set_format(settings, kFormatRisingEdge, parse_choice(value, "rising", "falling"));
  } else if (key == "name") {
    settings.name = parse_name(model, value);
  } else {
    return false;
  }
  return true;
}

}  // namespace ex9000::sim
