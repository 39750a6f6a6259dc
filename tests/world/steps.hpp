// What happens to a plant.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "hal/serial_mode.hpp"
#include "sim/virtual_line/faults/noise.hpp"
#include "tests/oracles/reference/module.hpp"

namespace ex9000::world {

using reference::Bytes;
using reference::Time;

struct Send {
  std::size_t master;
  hal::SerialMode mode;
  Bytes bytes;
};
struct Wait {
  Time time;
};
struct Power {
  std::size_t module;
  bool on;
};
struct Reset {
  std::size_t module;
};
struct Init {
  std::size_t module;
  bool asserted;
};
struct Input {
  std::size_t module;
  unsigned channel;
  bool level;
};
struct Pulse {
  std::size_t module;
  unsigned channel;
  std::uint32_t count;
};
/// The main loop does nothing.
struct Hang {
  std::size_t module;
  Time time;  ///< 0: until a reset
};
struct TickStops {
  std::size_t module;
};
struct MemoryFails {
  std::size_t module;
  bool on;
};
/// The flash of the slots.
struct SlotsFail {
  std::size_t module;
  bool on;
};
/// A new image hangs when it starts.
struct BadImages {
  std::size_t module;
  bool on;
};
/// The next reply does not reach the wires, or late.
struct SpoilReply {
  std::size_t module;
  Time late_by;  ///< 0: lost
};
struct Noise {
  sim::NoiseRates rates;
};

using Step = std::variant<Send, Wait, Power, Reset, Init, Input, Pulse, Hang, TickStops, MemoryFails,
                          SlotsFail, BadImages, SpoilReply, Noise>;

std::string text_of(const Step& step);
/// The module that the step concerns; null: none.
std::size_t* module_of(Step& step);

/// A module of a plant.
struct Member {
  const reference::ModelRow* row;
  bool blank;  ///< the memory is blank, so `stored` has the factory settings
  reference::Stored stored;
  unsigned serial_number;  ///< of the board
};

struct Setup {
  std::vector<Member> members;
  Time begins{0};  ///< the line's time at first
  std::size_t masters = 1;
};

std::string text_of(const Setup& setup);

}  // namespace ex9000::world
