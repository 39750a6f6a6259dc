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
  /// Throws std::runtime_error if the step fails.
  std::function<void(Playing& playing)> run;
  bool acts = false;  ///< the step changes modules, lines or faults: see `rehearse`

  [[nodiscard]] sim::Words words() const { return sim::words_of(text); }
};

/// A transcript on one model, or a scenario on a bus.
struct Transcript {
  std::string file;
  const Model* model = nullptr;  ///< null: a scenario
  /// The model, the header's variables and, if runs differ in it, the preset. Empty: a scenario.
  std::string run;
  Settings preset;  ///< of a transcript: factory settings with the changes from the header
  bool preset_given = false;
  bool slow = false;
  bool blank_memory = false;  ///< requires a module that has never stored anything
  std::vector<Step> steps;
};

/// Of a `silence` step. Without faults, an idle module begins its reply within this time.
constexpr std::chrono::milliseconds kSilence{250};

/// Below `directory`, ending with .txt, sorted. Throws std::filesystem::filesystem_error.
std::vector<std::string> transcript_files(const std::string& directory);

/// For each model and `with:` line of a transcript; one for a scenario. Errors name the file and the line.
std::vector<Transcript> load(const std::string& path);
/// Of a file, or of all files in a folder; at least one.
std::vector<Transcript> load_all(const std::string& path);

}  // namespace ex9000::play
