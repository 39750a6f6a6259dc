#include "tests/oracles/reference/extension_forms.hpp"

#include <optional>

#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/oracles/reference/modbus_refusal.hpp"

namespace ex9000::reference {

bool has_line_format(unsigned baud_code) { return baud_code >= 0x40 && baud_code <= 0xFF; }

bool is_extension_command(char delimiter, const std::string& body) {
  if (delimiter == '%') {
    const std::optional<unsigned> baud_code = number(body.size() == 8 ? body.substr(4, 2) : "");
    return baud_code && has_line_format(*baud_code);
  }
  return delimiter == '~' && (body[0] == 'R' || body[0] == 'X');
}

bool is_extension_function(const Bytes& frame) {
  if (frame.size() < 6) {
    return false;
  }
  constexpr unsigned kBaudCode = 0x01E5;
  const unsigned function = frame[1];
  const unsigned first = word(frame, 2);
  switch (function) {
    case 0x01:
    case 0x05:
    case 0x0F:
      return first == 0x08CA;
    case 0x06:
      if (first == kBaudCode && has_line_format(word(frame, 4))) {
        return true;
      }
      break;
    case 0x10: {
      const std::size_t at = first <= kBaudCode ? 7 + 2 * (kBaudCode - first) : frame.size();
      if (frame.size() >= at + 2 && has_line_format(word(frame, at))) {
        return true;
      }
      break;
    }
    case 0x03:
    case 0x04:
      break;
    default:
      return false;
  }
  return first >= 0x0240 && first <= 0x030F;
}

}  // namespace ex9000::reference
