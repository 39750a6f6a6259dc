// What a module counts on its line since reset or clearing (firmware/extensions.md, wire.md D1).
#pragma once

#include <cstdint>

#include "firmware/request/exchange.hpp"

namespace ex9000::registers {

/// In the order of registers 0x0308 to 0x030F. Function 08 reads the first six.
enum class Tally : std::uint8_t {
  BusMessages,
  BusErrors,
  Exceptions,
  ServerMessages,
  NoResponses,
  Overruns,
  DamagedBytes,
  LostFrames,
};

/// Modulo 65536, with the request of `exchange` if `tally` counts it.
inline std::uint16_t count_of(const Exchange& exchange, Tally tally) {
  const LineTallies& line = exchange.tallies;
  const Diagnostics& own = exchange.state.diagnostics;
  unsigned count = 0;
  switch (tally) {  // not covered: the enumeration has no other value
    case Tally::BusMessages:
      count = line.bus_messages();
      break;
    case Tally::BusErrors:
      count = line.bus_errors();
      break;
    case Tally::Exceptions:
      count = own.exceptions;
      break;
    case Tally::ServerMessages:
      count = line.server_messages();
      break;
    case Tally::NoResponses:
      count = line.no_responses() + own.no_responses;
      break;
    case Tally::Overruns:
      count = line.overruns();
      break;
    case Tally::DamagedBytes:
      count = line.damaged_bytes();
      break;
    case Tally::LostFrames:
      count = line.lost_frames();
      break;
  }
  return static_cast<std::uint16_t>(count);
}

}  // namespace ex9000::registers
