// The kinds of faults, and when a fault occurs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/virtual_line/bus/bus.hpp"

namespace ex9000::sim {

/// The kinds of faults.
enum class Trouble {
  BitErrors,
  LostBytes,
  InsertedBytes,
  StrayZeros,
  Echo,
  ForeignTraffic,
  LostReply,
  LateReply,
  LateDriver,
  WrongRate,
  Gone,
  PowerCut,
  Hang,
};

/// When a fault occurs, that is, takes effect, and how long the fault lasts.
struct Schedule {
  enum class When { Always, At, EveryTime, EveryReply, Probably, AfterWrites };

  When when = When::Always;
  VirtualTime time{0};      ///< At: the scheduled time, in the line's time; EveryTime: the period
  std::uint64_t count = 1;  ///< EveryReply: 10 means every 10th reply; AfterWrites: number of EEPROM writes
  double probability = 0;   ///< Probably: the probability for each reply
  /// How long the fault lasts after it begins. A hang and foreign traffic have no duration, so `lasts` is
  /// nullopt. A power cut always has a duration. For the other kinds of faults, nullopt means: a fault that a
  /// reply triggers lasts until the end of this reply, and a fault with any other schedule is permanent.
  std::optional<VirtualTime> lasts;

  [[nodiscard]] bool of_replies() const { return when == When::EveryReply || when == When::Probably; }
};

struct Fault {
  Trouble trouble = Trouble::BitErrors;
  double probability = 0;           ///< the probability for each bit or byte
  VirtualTime time{0};              ///< the delay of a late reply, a late driver or an echo
  std::uint32_t baud = 0;           ///< the wrong rate
  std::vector<std::uint8_t> bytes;  ///< the foreign bytes
  Schedule schedule;
  std::optional<std::size_t> module;  ///< the position on the line, from 0; nullopt: all modules
  std::string text;                   ///< the notation of the user, with single spaces
};

}  // namespace ex9000::sim
