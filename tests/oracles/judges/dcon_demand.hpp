// The effects that a DCON command must have: an independent implementation of wire.md 4 and 12.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/bytes.hpp"
#include "tests/oracles/judges/demand.hpp"
#include "tests/oracles/judges/rtu_demand.hpp"

namespace ex9000::judges {

namespace detail {

/// Returns the value of `digits`, modulo 2^32; no value if a character is not an upper-case hex digit.
constexpr std::optional<unsigned> hex_number(Bytes digits) {
  unsigned number = 0;
  for (const std::uint8_t digit : digits) {
    const bool decimal = digit >= '0' && digit <= '9';
    if (!decimal && (digit < 'A' || digit > 'F')) {
      return std::nullopt;
    }
    number = number * 16 + (decimal ? digit - '0' : digit - 'A' + 10U);
  }
  return number;
}

/// Returns the effects of `#AABBDD`. `text`: the command from BB on.
constexpr Demand demand_of_group_or_single(Bytes text, unsigned outputs) {
  const auto data = hex_number(text.from(2));
  if (!data) {
    return {};
  }
  const std::uint8_t kind = text[0];
  const std::uint8_t second = text[1];
  unsigned first = 0;
  unsigned count = 1;
  if ((kind == '0' && (second == '0' || second == 'A'))) {
    count = outputs < 8 ? outputs : 8;
  } else if (kind == '0' && second == 'B' && outputs > 8) {
    first = 8;
    count = outputs - 8;
  } else if ((kind == '1' || kind == 'A' || kind == 'B') && second >= '0' && second <= '7') {
    first = second - '0' + (kind == 'B' ? 8U : 0U);
  } else {
    return {};
  }
  if (first + count > outputs || *data >= 1U << count) {
    return {};
  }
  Demand demand;
  demand.channels = static_cast<std::uint16_t>(((1U << count) - 1U) << first);
  demand.levels = static_cast<std::uint16_t>(*data << first);
  return demand;
}

/// Returns the effects of `@AA(Data)`. `digits`: the data.
constexpr Demand demand_of_all(Bytes digits, unsigned outputs) {
  const std::size_t most = outputs > 8 ? 4 : outputs > 4 ? 2 : 1;
  const auto data = hex_number(digits);
  if (outputs == 0 || !data || (digits.size != most && digits.size * 2 != most) || *data >= 1UL << outputs) {
    return {};
  }
  Demand demand;
  demand.channels = static_cast<std::uint16_t>((1UL << outputs) - 1UL);
  demand.levels = static_cast<std::uint16_t>(*data);
  return demand;
}

/// Returns the effects of a `~AA` command. `text`: the command from the character after AA on.
constexpr Demand demand_of_tilde(Bytes text, unsigned outputs) {
  Demand demand;
  demand.stores_something = text[0] == 'O' || text[0] == '1' || text[0] == '3' || text[0] == '5' ||
                            (text[0] == 'X' && text.size == 9) || (text[0] == 'R' && text.size == 4);
  if (text[0] == '1' && text.size == 1) {
    demand.clears_timeout = true;
  } else if (text[0] == '3' && text.size == 4 && (text[1] == '0' || text[1] == '1')) {
    const auto timeout = hex_number(text.from(2));
    if (timeout && *timeout != 0) {
      demand.enabled = text[1] == '1';
      demand.restarts = text[1] == '1';
      demand.timeout = static_cast<std::uint8_t>(*timeout);
    }
  } else if (text[0] == '5' && text.size == 2 && outputs != 0) {
    demand.keeps_power_on = text[1] == 'P';
    demand.keeps_safe = text[1] == 'S';
  } else if (text[0] == 'X' && text.size == 9) {
    const auto address = hex_number(text.from(1).first(4));
    const auto value = hex_number(text.from(5));
    if (address && value && *address >= kTimedOutputs && *address < kTimedOutputs + outputs) {
      add_timed_output(*address - kTimedOutputs, *value, demand);
      demand.stores_something = false;
    }
  }
  return demand;
}

}  // namespace detail

/// Returns the effects of `command` on a module with `outputs` outputs. `command` has at least delimiter and
/// address, but no checksum and no CR.
constexpr Demand dcon_demand(Bytes command, unsigned outputs) {
  const Bytes text = command.from(3);
  Demand demand;
  if (text.size == 0) {
    return demand;
  }
  switch (command[0]) {
    case '#':
      return text.size == 4 ? detail::demand_of_group_or_single(text, outputs) : demand;
    case '@':
      return detail::demand_of_all(text, outputs);
    case '~':
      return detail::demand_of_tilde(text, outputs);
    case '%':
      demand.stores_something = text.size == 8;
      return demand;
    default:
      demand.stores_something = text[0] == 'P' && text.size == 2;
      return demand;
  }
}

/// Returns whether the command is `#AABBDD` or `@AA(Data)`. Such a command drives outputs unless
/// the module refuses the command.
constexpr bool is_dcon_output_command(Bytes command) {
  return (command[0] == '#' && command.size == 7) || (command[0] == '@' && command.size > 3);
}

/// Returns true for every command that can set the response delay (wire.md 12), and for some other commands.
constexpr bool may_set_delay_by_dcon(Bytes command) {
  return command.size > 4 && command[0] == '~' && (command[3] == 'R' || command[3] == 'X');
}

/// Returns NN, the new address in `%AANNTTCCFF`. NN is two hex digits in every `%` command that the module
/// executes.
constexpr std::uint8_t new_address(Bytes command) {
  const auto value = [](unsigned digit) { return digit > '9' ? digit - 'A' + 10 : digit - '0'; };
  return static_cast<std::uint8_t>(value(command[3]) * 16 + value(command[4]));
}

}  // namespace ex9000::judges
