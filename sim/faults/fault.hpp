// A fault as people write it: what goes wrong, and when.
//
//   bit-errors 1e-4                     of each bit on the line
//   lost-reply every 10th reply
//   late-reply 50ms with probability 0.01
//   gone at 12.5s for 2s
//   power-cut after 3 writes
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/bus.hpp"

namespace ex9000::sim {

/// What can go wrong.
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

/// When it does.
struct Schedule {
  enum class When { Always, At, EveryTime, EveryReply, Probably, AfterWrites };

  When when = When::Always;
  VirtualTime time{0};      ///< At: since the line exists; EveryTime: the period
  std::uint64_t count = 1;  ///< EveryReply, AfterWrites
  double probability = 0;   ///< Probably: of each reply
  /// From when it strikes; nothing: for good, or of a reply until that is over.
  std::optional<VirtualTime> lasts;

  [[nodiscard]] bool of_replies() const { return when == When::EveryReply || when == When::Probably; }
};

struct Fault {
  Trouble trouble = Trouble::BitErrors;
  double probability = 0;           ///< of each bit or byte
  VirtualTime time{0};              ///< by which something is late
  std::uint32_t baud = 0;           ///< the wrong one
  std::vector<std::uint8_t> bytes;  ///< the foreign ones
  Schedule schedule;
  std::optional<std::size_t> module;  ///< whose, from 0; nothing: all modules' of the line
  std::string text;                   ///< as it was written
};

/// Whether it befalls a module, and not the line.
bool befalls_a_module(Trouble trouble);

/// `text` is `TROUBLE [VALUE] [SCHEDULE]`; of all modules of the line where it befalls one. Throws
/// std::invalid_argument, one line that names what is wrong and what would be right.
Fault parse_fault(const std::string& text);

/// What can be written, a line each, for --help and the manual.
std::string fault_help();

}  // namespace ex9000::sim
