#include "sim/app/play/transcript.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>

#include "sim/app/play/steps.hpp"
#include "sim/files_and_ports/files/regular_file.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::play {

namespace {

using sim::fail;
using sim::open_text_file;
using Variables = std::map<std::string, std::string>;

struct Line {
  unsigned number;
  std::string text;
};

struct ModelRun {
  const Model* model;
  Variables variables;
  sim::Words presets;
  unsigned preset_line = 0;
};

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  const auto last = text.find_last_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

const Model& model_named(const std::string& name) {
  const Model* model = find_model(name);
  if (model == nullptr) {
    sim::refuse_model(name);
  }
  return *model;
}

/// The settings of a `preset:` line.
Settings preset_of(const ModelRun& run) {
  sim::ModuleSpec spec = sim::factory_fresh(*run.model);
  for (const std::string& word : run.presets) {
    const auto equals = word.find('=');
    const std::string key = word.substr(0, equals);
    sim::take_module_setting(
        spec, key, "preset " + key + "=: ", equals == std::string::npos ? "" : word.substr(equals + 1));
  }
  return spec.settings;
}

std::string substitute(std::string text, const Variables& variables) {
  for (const auto& [name, value] : variables) {
    const std::string pattern = "{" + name + "}";
    for (auto at = text.find(pattern); at != std::string::npos; at = text.find(pattern, at + value.size())) {
      text.replace(at, pattern.size(), value);
    }
  }
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_0123456789";
  for (auto at = text.find('{'); at != std::string::npos; at = text.find('{', at + 1)) {
    const auto end = text.find_first_not_of(kLetters, at + 1);
    if (end != std::string::npos && end != at + 1 && text[end] == '}') {
      const std::string name = text.substr(at + 1, end - at - 1);
      fail("'{" + name + "}': unknown variable; add its value to the 'model:' line");
    }
  }
  return text;
}

std::optional<std::string> header_value(const std::string& text, const std::string& key) {
  return text.rfind(key + ":", 0) == 0 ? std::optional(trimmed(text.substr(key.size() + 1))) : std::nullopt;
}

/// The content of a file before it is combined with a model.
struct Source {
  bool names_its_source = false;
  bool slow = false;
  std::vector<ModelRun> models;
  std::size_t preset_ends = 0;  ///< the models before this index have a `preset:` line
  std::vector<Line> steps;
};

bool read_header(const std::string& text, unsigned number, Source& source) {
  if (const auto from = header_value(text, "source")) {
    source.names_its_source = !from->empty();
  } else if (const auto model = header_value(text, "model")) {
    const sim::Words word = sim::words_of(*model);
    if (word.empty()) {
      fail("'model:' requires a model's name");
    }
    ModelRun run{&model_named(word[0]), {}, {}, 0};
    for (std::size_t i = 1; i < word.size(); ++i) {
      const auto equals = word[i].find('=');
      if (equals == std::string::npos) {
        fail("'" + word[i] + "': expected KEY=VALUE");
      }
      const std::string key = word[i].substr(0, equals);
      if (!run.variables.insert({key, word[i].substr(equals + 1)}).second) {
        fail("'" + key + "' is given twice; leave out one of them");
      }
    }
    source.models.push_back(run);
  } else if (const auto preset = header_value(text, "preset")) {
    if (source.preset_ends == source.models.size()) {
      fail("'preset:' requires a preceding 'model:' line without a preset");
    }
    for (; source.preset_ends < source.models.size(); ++source.preset_ends) {
      source.models[source.preset_ends].presets = sim::words_of(*preset);
      source.models[source.preset_ends].preset_line = number;
    }
  } else if (const auto tags = header_value(text, "tags")) {
    if (*tags != "slow") {
      fail("'" + *tags + "' is not a tag; expected slow");
    }
    source.slow = true;
  } else {
    return false;
  }
  return true;
}

void read_line(const std::string& raw, unsigned number, Source& source) {
  const auto comment = raw.find("  ;");
  const std::string text = trimmed(raw[0] == ';' ? "" : raw.substr(0, comment));
  if (text.empty()) {
    return;
  }
  if (source.steps.empty() && read_header(text, number, source)) {
    return;
  }
  source.steps.push_back({number, text});
}

Transcript scenario(const std::string& path, const Source& source, unsigned& line) {
  if (source.slow) {
    fail("'tags:' requires a 'model:' line");
  }
  Transcript transcript;
  transcript.file = path;
  for (const Line& raw : source.steps) {
    line = raw.number;
    transcript.steps.push_back(parse_step(raw.number, raw.text, nullptr));
  }
  return transcript;
}

Transcript transcript_of(const std::string& path, const Source& source, const ModelRun& run, unsigned& line) {
  Transcript transcript;
  transcript.file = path;
  transcript.model = run.model;
  transcript.preset_given = !run.presets.empty();
  line = run.presets.empty() ? line : run.preset_line;
  transcript.preset = preset_of(run);
  transcript.slow = source.slow;
  for (const Line& raw : source.steps) {
    line = raw.number;
    const std::string text = substitute(raw.text, run.variables);
    transcript.steps.push_back(parse_step(raw.number, text, run.model));
  }
  return transcript;
}

}  // namespace

std::vector<std::string> transcript_files(const std::string& directory) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory)) {
    if (entry.path().extension() == ".txt" && !entry.is_directory()) {
      files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<Transcript> load(const std::string& path) {
  std::ifstream file = open_text_file(path);
  if (!file.is_open()) {
    fail(path + ": cannot be read; name a transcript, a scenario or a folder of such files");
  }
  unsigned line = 0;
  try {
    Source source;
    for (std::string raw; std::getline(file, raw);) {
      read_line(raw, ++line, source);
    }
    line = 1;
    if (source.steps.empty()) {
      fail("has no step; add one");
    }
    if (source.models.empty() && source.names_its_source) {
      fail("has 'source:', but no 'model:' line; add one, or remove 'source:'");
    }
    if (source.models.empty()) {
      return {scenario(path, source, line)};
    }
    if (!source.names_its_source) {
      fail("has no source; add a line such as 'source: EX9042D manual 2.6'");
    }
    std::vector<Transcript> transcripts;
    for (const ModelRun& run : source.models) {
      transcripts.push_back(transcript_of(path, source, run, line));
    }
    return transcripts;
  } catch (const std::exception& error) {
    fail(path + ":" + std::to_string(line) + ": " + error.what());
  }
}

}  // namespace ex9000::play
