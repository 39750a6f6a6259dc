// A fault: its kind, what the kind does, and when the fault occurs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "firmware/request/state.hpp"
#include "sim/virtual_line/faults/noise.hpp"
#include "sim/virtual_line/wires/module_wire.hpp"
#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

/// When a fault takes effect ("occurs"), and for how long.
struct Schedule {
  enum class When { Always, At, EveryTime, EveryReply, Probably, AfterWrites };

  When when = When::Always;
  VirtualTime time{0};      ///< At: the scheduled time, in the line's time; EveryTime: the period
  std::uint64_t count = 1;  ///< EveryReply: 10 means every 10th reply; AfterWrites: number of EEPROM writes
  double probability = 0;   ///< Probably: the probability for each reply
  /// nullopt: until the end of the reply that triggers the fault; with any other schedule, for ever.
  std::optional<VirtualTime> lasts;

  [[nodiscard]] bool of_replies() const { return when == When::EveryReply || when == When::Probably; }
};

/// What all active faults do together, to the wires and to a module.
struct LineFaults {
  NoiseRates noise;
  std::optional<VirtualTime> echo_after;
  std::vector<std::uint8_t> foreign_bytes;
};

struct ModuleFaults {
  bool no_supply = false;
  bool hangs = false;
  bool bad_images = false;
  std::uint32_t rate = 0;  ///< 0: the module's own rate
  VirtualTime driver_late_by{0};
};

struct Fault;

/// A kind of fault. It does not undo its effect: when a fault begins or ends, the scheduler starts from no
/// effect and calls the `effect` of each active fault, in the order of their addition.
struct FaultKind {
  enum class Value { None, Probability, Time, Pause, Rate, Byte, Bytes };
  enum class Lasts {
    Reply,   ///< if a reply triggers the fault, until the end of this reply by default
    Open,    ///< no default: the user gives the time after `for`, or removes the fault
    Second,  ///< one second by default
    Moment,  ///< no time: the scheduler calls `effect` once for each occurrence
  };
  using OnLine = void (*)(const Fault& fault, LineFaults& line);
  using OnModule = void (*)(const Fault& fault, ModuleFaults& module);
  /// Before the module sends a reply. `state`: the module's.
  using OnReply = void (*)(const Fault& fault, Reply& reply, const State& state);

  std::string_view name;
  Value value;
  std::string_view usual;  ///< a typical value, a typical schedule, or both; may be empty
  Lasts lasts;
  std::variant<OnLine, OnModule, OnReply> effect;
  std::string_view does;  ///< for --help

  [[nodiscard]] bool is_of_the_line() const { return std::holds_alternative<OnLine>(effect); }
};

struct Fault {
  const FaultKind* kind = nullptr;  ///< an element of `fault_kinds`
  // The value; a kind uses at most one of these.
  double probability = 0;
  VirtualTime time{0};
  std::uint32_t rate = 0;
  std::vector<std::uint8_t> bytes;
  Schedule schedule;
  std::optional<std::size_t> module;  ///< the position on the line, from 0; nullopt: all modules
  std::string text;                   ///< the notation of the user, with single spaces
  std::size_t number = 0;             ///< set by Faults::add
};

const std::vector<FaultKind>& fault_kinds();

}  // namespace ex9000::sim
