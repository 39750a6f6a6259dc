// A conformance transcript or a scenario as data. tests/conformance/README.md defines the format.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
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
  Bytes frame;  ///< without CRC
};
struct ExpectModbus {
  std::vector<Bytes> frames;  ///< the permitted replies, at least one, all of the same length; without CRC
};
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
struct Format {
  LineFormat format;
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
// The following steps are valid only in scenarios, because transcripts have no bus.
struct OnModule {
  std::size_t position;  ///< from 0, across all lines
};
struct OnLine {
  std::string name;
};
struct FaultCommand {
  std::string command;  ///< see Target::run_fault_command
};

}  // namespace step

using Action =
    std::variant<step::SendDcon, step::ExpectDcon, step::SendModbus, step::ExpectModbus, step::SendBytes,
                 step::Silence, step::Wait, step::Checksum, step::Baud, step::Format, step::Power,
                 step::PowerCycle, step::Reset, step::Init, step::Input, step::Pulse, step::Outputs,
                 step::Led, step::OnModule, step::OnLine, step::FaultCommand>;

struct Step {
  unsigned line;     ///< line number in the file, from 1
  std::string text;  ///< the step without its comment; variables are replaced
  Action action;
};

/// One run of a file: a transcript on one model, or a scenario, which runs on a bus.
struct Transcript {
  std::string file;
  const Model* model = nullptr;  ///< null: a scenario
  Settings preset;               ///< of a transcript: factory settings with the changes from the header
  bool preset_given = false;
  bool slow = false;
  std::vector<Step> steps;
};

/// The duration of a `silence` step, in which no byte may arrive. Without faults, an idle module begins its
/// reply to a request within this time.
constexpr std::chrono::milliseconds kSilence{250};

/// Returns an error message if `model` has no input `channel`; otherwise an empty string.
std::string missing_input(const Model& model, unsigned channel);

/// Returns the paths of all files below `directory` that end with .txt, sorted. Throws
/// std::filesystem::filesystem_error if a directory cannot be read.
std::vector<std::string> transcript_files(const std::string& directory);

/// Returns all runs of a transcript, one for each `model:` line, or the single run of a scenario. Throws
/// std::invalid_argument that names the file, the line (if the file can be read) and what is wrong.
std::vector<Transcript> load(const std::string& path);

}  // namespace ex9000::play
