// A conformance transcript or a scenario as data. tests/conformance/README.md defines the format.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/text/words.hpp"

namespace ex9000::play {

using Bytes = std::vector<std::uint8_t>;

class Playing;

struct Step {
  unsigned line;     ///< line number in the file, from 1
  std::string text;  ///< the step without its comment; variables are replaced
  /// Carries out the step. Throws std::runtime_error if the step fails.
  std::function<void(Playing& playing)> run;
  bool acts = false;  ///< the step changes modules, lines or faults: see `rehearse`

  [[nodiscard]] sim::Words words() const { return sim::words_of(text); }
};

/// One run of a file: a transcript on one model, or a scenario, which runs on a bus.
struct Transcript {
  std::string file;
  const Model* model = nullptr;  ///< null: a scenario
  /// The model, the variables from the header and, if not all runs have the same, the preset. Empty: a
  /// scenario.
  std::string run;
  Settings preset;  ///< of a transcript: factory settings with the changes from the header
  bool preset_given = false;
  bool slow = false;
  std::vector<Step> steps;
};

/// The duration of a `silence` step, in which no byte may arrive. Without faults, an idle module begins its
/// reply to a request within this time.
constexpr std::chrono::milliseconds kSilence{250};

/// Returns the paths of all files below `directory` that end with .txt, sorted. Throws
/// std::filesystem::filesystem_error if a directory cannot be read.
std::vector<std::string> transcript_files(const std::string& directory);

/// Returns all runs of a transcript, one for each model and `with:` line, or the single run of a scenario.
/// Throws std::invalid_argument that names the file, the line (if the file can be read) and what is wrong.
std::vector<Transcript> load(const std::string& path);

}  // namespace ex9000::play
