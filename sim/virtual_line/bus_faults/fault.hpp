// A fault in the notation of the user: the kind of fault, then a value and a schedule, if the fault has them.
//
//   bit-errors 1e-4                     probability for each bit on the line
//   lost-reply every 10th reply
//   late-reply 50ms with probability 0.01
//   gone at 12.5s for 2s
//   power-cut after 3 writes
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

/// Returns true if a fault of this kind affects a module, false if it affects the wires.
bool concerns_a_module(Trouble trouble);

/// Parses `TROUBLE [VALUE] [SCHEDULE]`. The result applies to all modules of the line; the caller may set
/// `module`. Throws std::invalid_argument with a one-line message that says what is wrong and what would be
/// right.
Fault parse_fault(const std::string& text);

/// Returns a typical fault of each kind, in the notation of the user.
std::vector<std::string> usual_faults();

/// Returns one line for each kind of fault, with its name, its value and its effect, for --help.
std::string fault_help();

}  // namespace ex9000::sim
