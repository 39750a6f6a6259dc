// A conformance transcript, or a scenario, as data; tests/conformance/README.md is their format.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000::play {

using Bytes = std::vector<std::uint8_t>;

namespace step {

struct SendDcon {
  std::string text;
};
struct ExpectDcon {
  std::string text;
};
struct SendModbus {
  Bytes frame;
};  ///< without CRC
struct ExpectModbus {
  Bytes frame;
};  ///< likewise
struct SendBytes {
  Bytes bytes;
};
struct Silence {};
struct Wait {
  std::chrono::nanoseconds time;
};
struct Checksum {
  bool on;
};
struct Baud {
  std::uint32_t rate;
};
struct Power {
  bool on;
};
struct PowerCycle {};
struct Reset {};
struct Init {
  bool asserted;
};
struct Input {
  unsigned channel;
  bool level;
};
struct Pulse {
  unsigned channel;
  std::uint32_t count;
};
struct Outputs {
  std::uint16_t channels;
};
struct Led {
  enum class Shows { On, Off, Flashing } shows;
};
// Of scenarios, which have a bus.
struct OnModule {
  std::size_t position;
};  ///< from 0, through all lines
struct OnLine {
  std::string name;
};
struct Trouble {
  std::string command;
};  ///< see Target::trouble

}  // namespace step

using Action = std::variant<step::SendDcon, step::ExpectDcon, step::SendModbus, step::ExpectModbus,
                            step::SendBytes, step::Silence, step::Wait, step::Checksum, step::Baud,
                            step::Power, step::PowerCycle, step::Reset, step::Init, step::Input, step::Pulse,
                            step::Outputs, step::Led, step::OnModule, step::OnLine, step::Trouble>;

struct Step {
  unsigned line;     ///< in the file, from 1
  std::string text;  ///< as written, variables replaced
  Action action;
};

/// One run of a file on one model; a scenario has none, but a bus to play on.
struct Transcript {
  std::string file;
  const Model* model = nullptr;  ///< null: a scenario
  Settings preset;               ///< factory settings with what the header changes
  bool preset_given = false;
  bool slow = false;
  std::vector<Step> steps;

  /// `wait` and `silence` together, rounded up.
  [[nodiscard]] std::chrono::milliseconds waits() const;
};

/// Nothing may be heard in this time where `silence` is expected; longer than any reply may take.
constexpr std::chrono::milliseconds kSilence{250};

/// What is wrong with an input of this number on `model`; empty: it has it.
std::string missing_input(const Model& model, unsigned channel);

/// The transcripts below `directory`, in the order of their paths.
std::vector<std::string> transcript_files(const std::string& directory);

/// All runs of a file, one a `model:` line, or the one scenario that it is. Throws std::invalid_argument that
/// names file, line and what is wrong.
std::vector<Transcript> load(const std::string& path);
/// The same of files that are no scenarios.
std::vector<Transcript> load_transcripts(const std::string& path);

}  // namespace ex9000::play
