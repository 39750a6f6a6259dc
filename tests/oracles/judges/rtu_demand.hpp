// The effects that a Modbus request must have: an independent implementation of wire.md 7 and 12.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "tests/oracles/judges/demand.hpp"

namespace ex9000::judges {

namespace detail {

/// Returns the effects of a write to `count` coils from `first` on. Bit n of `levels` is the level of coil
/// `first` + n. Returns no effects unless all coils are outputs, all are bits of the safe value, or all are
/// bits of the power-on value.
constexpr Demand demand_of_coils(unsigned first, unsigned count, std::uint32_t levels, unsigned outputs) {
  const unsigned row = first & 0xFFE0U;
  const unsigned channel = first % 0x20;
  Demand demand;
  if ((row != 0x0000 && row != 0x0080 && row != 0x00A0) || channel + count > outputs) {
    return demand;
  }
  const std::uint32_t mask = (std::uint32_t{1} << count) - 1;
  demand.channels = static_cast<std::uint16_t>(mask << channel);
  demand.levels = static_cast<std::uint16_t>((levels & mask) << channel);
  demand.of_safe = row == 0x0080;
  demand.of_power_on = row == 0x00A0;
  demand.stores_something = row != 0x0000;
  return demand;
}

constexpr Demand demand_of_one_coil(Bytes request, unsigned outputs) {
  if (request.size != 6) {
    return {};
  }
  const unsigned coil = request.word(2);
  const unsigned value = request.word(4);
  if (value != 0xFF00 && value != 0x0000) {
    return {};
  }
  const bool on = value != 0;
  Demand demand;
  switch (coil) {
    case 0x0100:
    case 0x08CA:
      demand.stores_something = true;
      return demand;
    case 0x0104:
      demand.stores_something = true;
      demand.enabled = on;
      demand.restarts = on;
      return demand;
    case 0x010D:
      demand.stores_something = true;
      demand.clears_timeout = on;
      return demand;
    default:
      return demand_of_coils(coil, 1, on ? 1 : 0, outputs);
  }
}

constexpr Demand demand_of_more_coils(Bytes request, unsigned outputs) {
  if (request.size < 8) {
    return {};
  }
  const unsigned count = request.word(4);
  const unsigned bytes = (count + 7) / 8;
  constexpr unsigned kMost = 16;
  if (count < 1 || count > kMost || request[6] != bytes || request.size != 7 + bytes) {
    return {};
  }
  return demand_of_coils(request.word(2), count, request[7] | (bytes == 2 ? request[8] * 256U : 0U), outputs);
}

/// The timed outputs begin at this register.
inline constexpr unsigned kTimedOutputs = 0x0280;

/// Adds the effect of a write to the timed output `channel` (wire.md 12).
constexpr void add_timed_output(unsigned channel, unsigned value, Demand& demand) {
  const auto bit = static_cast<std::uint16_t>(1U << channel);
  demand.channels = static_cast<std::uint16_t>(demand.channels | bit);
  if (value != 0) {
    demand.levels = static_cast<std::uint16_t>(demand.levels | bit);
    demand.timers = static_cast<std::uint16_t>(demand.timers | bit);
    demand.units[channel] = static_cast<std::uint16_t>(value);
  }
}

/// Returns the effects of a write of `values` to `count` registers from `first` on. Returns no effects unless
/// all registers are timed outputs.
constexpr Demand demand_of_timed_outputs(unsigned first, unsigned count, Bytes values, unsigned outputs) {
  Demand demand;
  if (first < kTimedOutputs || first + count > kTimedOutputs + outputs) {
    return demand;
  }
  for (unsigned i = 0; i < count; ++i) {
    add_timed_output(first + i - kTimedOutputs, values.word(std::size_t{2} * i), demand);
  }
  return demand;
}

constexpr Demand demand_of_register(unsigned address, unsigned value) {
  Demand demand;
  demand.stores_something = true;
  if (address == 0x01E8 && value <= 0xFF) {
    demand.timeout = static_cast<std::uint8_t>(value);
    demand.restarts = true;
  }
  return demand;
}

}  // namespace detail

/// Returns whether the first register in a request with function 06 or 10 is a timed output of at least
/// one model.
constexpr bool is_timed_output(Bytes request) {
  constexpr unsigned kMost = 16;
  return request.size >= 4 && request.word(2) >= detail::kTimedOutputs &&
         request.word(2) < detail::kTimedOutputs + kMost;
}

/// Returns the effects of `request` on a module with `outputs` outputs. `request` has at least address and
/// function, but no CRC.
constexpr Demand rtu_demand(Bytes request, unsigned outputs) {
  constexpr std::size_t kOneRegister = 9;
  switch (request[1]) {
    case 0x05:
      return detail::demand_of_one_coil(request, outputs);
    case 0x0F:
      return detail::demand_of_more_coils(request, outputs);
    case 0x06:
      if (request.size == 6 && is_timed_output(request)) {
        return detail::demand_of_timed_outputs(request.word(2), 1, request.from(4), outputs);
      }
      return request.size == 6 ? detail::demand_of_register(request.word(2), request.word(4)) : Demand{};
    case 0x10:
      if (is_timed_output(request)) {
        const bool formed =
            request.size > 7 && request[6] == 2U * request.word(4) && request.size == 7U + request[6];
        return formed ? detail::demand_of_timed_outputs(request.word(2), request.word(4), request.from(7),
                                                        outputs)
                      : Demand{};
      }
      // A write of several registers cannot include the timeout register, because no register next to it is
      // writable.
      return request.size == kOneRegister && request.word(4) == 1 && request[6] == 2
                 ? detail::demand_of_register(request.word(2), request.word(7))
                 : detail::demand_of_register(0, 0);
    case 0x46:
      return detail::demand_of_register(0, 0);
    default:
      return {};
  }
}

/// Returns true for every output command, and for some requests that the module always refuses.
constexpr bool is_rtu_output_command(Bytes request) {
  if (request[1] == 0x06 || request[1] == 0x10) {
    return is_timed_output(request);
  }
  if (request.size < 4 || (request[1] != 0x05 && request[1] != 0x0F)) {
    return false;
  }
  return request.word(2) < 0x0100;
}

/// Returns whether the request is a write to register 0x0252, the response delay (wire.md 12). The module may
/// refuse or ignore this write.
constexpr bool may_set_delay_by_rtu(Bytes request) {
  constexpr unsigned kDelay = 0x0252;
  if (request.size < 6 || (request[1] != 0x06 && request[1] != 0x10)) {
    return false;
  }
  const unsigned first = request.word(2);
  return first <= kDelay && kDelay < first + (request[1] == 0x06 ? 1U : request.word(4));
}

}  // namespace ex9000::judges
