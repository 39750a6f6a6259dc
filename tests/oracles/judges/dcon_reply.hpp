// The format of DCON replies: an independent implementation of wire.md 3, 4 and 12.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/bytes.hpp"
#include "tests/oracles/judges/checks.hpp"
#include "tests/oracles/judges/reply_form.hpp"

namespace ex9000::judges {

/// The form of a reply depends on the request and on these properties of the module.
struct DconRules {
  std::uint8_t address = 0;
  bool init_mode = false;  ///< in INIT mode, `$002` returns the stored address
  bool inputs = false;     ///< the model has inputs
  bool outputs = false;    ///< the model has outputs
};

namespace detail {

/// A request, and the form of its valid reply. In `request`, `.` is any character, and `*` at the end is one
/// or more characters. In `answer`, `aa` is the address, `ss` the stored address, `nn` the address that `%`
/// sets, `h` a hex digit, `d` a decimal digit, `b` 0 or 1, `t` at the end a name of 1 to 7 characters, and
/// `w` at the end 4 or 8 hex digits. All other characters stand for themselves.
struct Shape {
  std::string_view request;
  std::string_view answer;
};

constexpr std::array<Shape, 28> kShapes{{
    {"%..........", "!nn"}, {"#......", ">"},        {"#...", "!aaddddd"}, {"$..2", "!sshhhhhh"},
    {"$..4", "!bhhhh00"},   {"$..5", "!aab"},        {"$..6", "!hhhh00"},  {"$..F", "!aaDdd.dd"},
    {"$..M", "!aat"},       {"$..C", "!aa"},         {"$..C.", "!aa"},     {"$..L0", "!hhhh00"},
    {"$..L1", "!hhhh00"},   {"$..P", "!aa1b"},       {"$..P.", "!aa"},     {"@..", ">hhhh"},
    {"@..*", ">"},          {"~..O*", "!aa"},        {"~..0", "!aahh"},    {"~..1", "!aa"},
    {"~..2", "!aabhh"},     {"~..3...", "!aa"},      {"~..4.", "!aahhhh"}, {"~..5.", "!aa"},
    {"~..X....", "!aaw"},   {"~..X........", "!aa"}, {"~..RD", "!aahh"},   {"~..RD..", "!aa"},
}};

constexpr bool is_request(std::string_view shape, Bytes request) {
  const bool open_end = shape.back() == '*';
  if (open_end ? request.size < shape.size() : request.size != shape.size()) {
    return false;
  }
  for (std::size_t i = 0; i < shape.size(); ++i) {
    if (shape[i] != '.' && shape[i] != '*' && static_cast<std::uint8_t>(shape[i]) != request[i]) {
      return false;
    }
  }
  return true;
}

constexpr bool is_decimal(std::uint8_t c) { return c >= '0' && c <= '9'; }
constexpr bool is_hex(std::uint8_t c) { return is_decimal(c) || (c >= 'A' && c <= 'F'); }
constexpr bool is_printable(std::uint8_t c) { return c >= 0x20 && c <= 0x7E; }

inline bool is_name(Bytes text) {
  for (const std::uint8_t c : text) {
    if (!is_printable(c)) {
      return false;
    }
  }
  return text.size >= 1 && text.size <= 7;
}

inline bool is_value(Bytes text) {
  for (const std::uint8_t c : text) {
    if (!is_hex(c)) {
      return false;
    }
  }
  return text.size == 4 || text.size == 8;
}

inline bool fits(char code, std::size_t at, Bytes request, Bytes reply, const DconRules& rules) {
  const std::uint8_t c = reply[at];
  const std::uint8_t own = upper_hex(at == 1 ? rules.address / 16U : rules.address);
  switch (code) {
    case 'a':
      return c == own;
    case 's':
      return is_hex(c) && (rules.init_mode || c == own);
    case 'n':
      return is_hex(c) && c == request[at + 2];
    case 'h':
      return is_hex(c);
    case 'd':
      return is_decimal(c);
    case 'b':
      return c == '0' || c == '1';
    default:
      return c == static_cast<std::uint8_t>(code);
  }
}

inline bool is_answer(std::string_view shape, Bytes request, Bytes reply, const DconRules& rules) {
  std::size_t size = shape.size();
  if (shape.back() == 't' || shape.back() == 'w') {
    --size;
    if (reply.size < size ||
        !(shape.back() == 't' ? is_name(reply.from(size)) : is_value(reply.from(size)))) {
      return false;
    }
  } else if (reply.size != size) {
    return false;
  }
  for (std::size_t i = 0; i < size; ++i) {
    if (!fits(shape[i], i, request, reply, rules)) {
      return false;
    }
  }
  return true;
}

/// Returns whether a refusal of this request is `?` or `!`, without an address (wire.md 3 and D12).
constexpr bool is_bare_where_refused(Bytes request, const DconRules& rules) {
  const bool is_of_outputs =
      (request[0] == '@' && request.size > 3) || (request[0] == '#' && (request.size != 4 || !rules.inputs));
  return rules.outputs && is_of_outputs;
}

}  // namespace detail

/// Returns how `reply` relates to `request`. Neither includes a checksum or a CR. The request has at least
/// delimiter and address.
inline ReplyForm dcon_reply_form(Bytes request, Bytes reply, const DconRules& rules) {
  if (detail::is_bare_where_refused(request, rules)) {
    if (reply.size == 1 && (reply[0] == '?' || reply[0] == '!')) {
      return ReplyForm::Refusal;
    }
  } else if (reply.size == 3 && reply[0] == '?' && are_digits_of(reply.data + 1, rules.address)) {
    return ReplyForm::Refusal;
  } else if (reply.size == 1 && reply[0] == '!' && detail::is_request("~..X........", request)) {
    return ReplyForm::Refusal;  // a write of a timed output while the timeout status is set
  }
  for (const detail::Shape& shape : detail::kShapes) {
    if (detail::is_request(shape.request, request)) {
      return detail::is_answer(shape.answer, request, reply, rules) ? ReplyForm::Answer : ReplyForm::Wrong;
    }
  }
  return ReplyForm::Wrong;
}

}  // namespace ex9000::judges
