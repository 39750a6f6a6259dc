#include "sim/app/play/transcript.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

#include "sim/app/play/model_table.hpp"
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

struct Line {
  unsigned number;
  std::string text;
};

/// Of a header line.
struct Given {
  std::string text;  ///< as in the file
  Variables variables;
};

struct ModelRun {
  const Model* model;
  Given given;
  std::string preset;
  unsigned preset_line = 0;
};

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  const auto last = text.find_last_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// Of a `preset:` line, in which variables are replaced.
Settings preset_of(const Model& model, const std::string& preset) {
  sim::ModuleSpec spec = sim::factory_fresh(model);
  for (const std::string& word : sim::words_of(preset)) {
    const auto equals = word.find('=');
    const std::string key = word.substr(0, equals);
    sim::take_module_setting(
        spec, key, "preset " + key + "=: ", equals == std::string::npos ? "" : word.substr(equals + 1));
  }
  return spec.settings;
}

std::string substitute(std::string text, const Variables& variables) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_0123456789";
  for (auto at = text.find('{'); at != std::string::npos; at = text.find('{', at)) {
    const auto end = text.find_first_not_of(kLetters, at + 1);
    if (end == std::string::npos || end == at + 1 || text[end] != '}') {
      ++at;
      continue;
    }
    const std::string name = text.substr(at + 1, end - at - 1);
    const auto variable = variables.find(name);
    if (variable == variables.end()) {
      fail("'{" + name + "}': unknown variable; add its value to the 'model:' or 'with:' line");
    }
    text.replace(at, end + 1 - at, variable->second);
    at += variable->second.size();
  }
  return text;
}

std::optional<std::string> header_value(const std::string& text, const std::string& key) {
  return text.rfind(key + ":", 0) == 0 ? std::optional(trimmed(text.substr(key.size() + 1))) : std::nullopt;
}

/// A file before it is combined with a model.
struct Source {
  ModelTable table;
  bool names_its_source = false;
  bool slow = false;
  bool blank_memory = false;
  std::vector<ModelRun> models;
  std::size_t preset_ends = 0;  ///< the models before this index have a `preset:` line
  std::vector<Given> withs;
  std::vector<Line> steps;
};

void add_all(const Variables& added, Variables& variables) {
  for (const auto& [name, value] : added) {
    if (!variables.insert({name, value}).second) {
      fail("'" + name + "' is given twice; leave out one of them");
    }
  }
}

/// Variables, VAR=TEXT, and the words before them.
std::pair<sim::Words, Given> words_and_variables(const std::string& text) {
  sim::Words words;
  Given given;
  for (const std::string& word : sim::words_of(text)) {
    const auto equals = word.find('=');
    if (equals != std::string::npos) {
      add_all({{word.substr(0, equals), word.substr(equals + 1)}}, given.variables);
      given.text += " " + word;
    } else if (given.text.empty()) {
      words.push_back(word);
    } else {
      fail("'" + word + "': expected VAR=TEXT");
    }
  }
  return {words, given};
}

/// Of a `models:` line if `by_class`, else of a `model:` line.
void add_models(const std::string& text, bool by_class, Source& source) {
  const auto [words, given] = words_and_variables(text);
  if (words.empty()) {
    fail(by_class ? "'models:' requires a class" : "'model:' requires a model's name");
  }
  std::vector<const Model*> models;
  if (by_class) {
    models = models_of(source.table, words);
  } else {
    std::transform(words.begin(), words.end(), std::back_inserter(models),
                   [](const std::string& name) { return &model_named(name); });
  }
  for (const Model* const model : models) {
    ModelRun run{model, given, {}, 0};
    for (const ModelEntry& entry : source.table) {
      if (entry.model == model) {
        add_all(entry.variables, run.given.variables);
      }
    }
    source.models.push_back(run);
  }
}

void add_preset(const std::string& text, unsigned number, Source& source) {
  if (source.preset_ends == source.models.size()) {
    fail("'preset:' requires a preceding 'model:' or 'models:' line without a preset");
  }
  for (; source.preset_ends < source.models.size(); ++source.preset_ends) {
    source.models[source.preset_ends].preset = text;
    source.models[source.preset_ends].preset_line = number;
  }
}

void add_with(const std::string& text, Source& source) {
  const auto [words, given] = words_and_variables(text);
  if (!words.empty() || given.text.empty()) {
    fail("'with:' requires VAR=TEXT");
  }
  source.withs.push_back(given);
}

void add_tags(const std::string& text, Source& source) {
  for (const std::string& tag : sim::words_of(text)) {
    if (tag != "slow" && tag != "blank-memory") {
      fail("'" + tag + "' is not a tag; expected slow or blank-memory");
    }
    (tag == "slow" ? source.slow : source.blank_memory) = true;
  }
}

bool read_header(const std::string& text, unsigned number, Source& source) {
  if (const auto from = header_value(text, "source")) {
    source.names_its_source = !from->empty();
  } else if (const auto model = header_value(text, "model")) {
    add_models(*model, false, source);
  } else if (const auto models = header_value(text, "models")) {
    add_models(*models, true, source);
  } else if (const auto preset = header_value(text, "preset")) {
    add_preset(*preset, number, source);
  } else if (const auto with = header_value(text, "with")) {
    add_with(*with, source);
  } else if (const auto tags = header_value(text, "tags")) {
    add_tags(*tags, source);
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
  const bool tagged = source.slow || source.blank_memory;
  if (tagged || !source.withs.empty()) {
    fail(std::string(tagged ? "'tags:'" : "'with:'") + " requires a 'model:' or 'models:' line");
  }
  Transcript transcript;
  transcript.file = path;
  for (const Line& raw : source.steps) {
    line = raw.number;
    transcript.steps.push_back(parse_step(raw.number, raw.text, nullptr));
  }
  return transcript;
}

bool have_different_presets(const std::vector<ModelRun>& runs) {
  return std::any_of(runs.begin(), runs.end(),
                     [&runs](const ModelRun& run) { return run.preset != runs[0].preset; });
}

/// `line`: the one that is read, for the message of an error.
Transcript transcript_of(const std::string& path, const Source& source, const ModelRun& run,
                         const Given& with, unsigned& line) {
  Variables variables = run.given.variables;
  for (const auto& [name, value] : with.variables) {
    add_all({{name, substitute(value, run.given.variables)}}, variables);
  }
  Transcript transcript;
  transcript.file = path;
  transcript.model = run.model;
  transcript.preset_given = !run.preset.empty();
  line = run.preset.empty() ? line : run.preset_line;
  const std::string preset = substitute(run.preset, variables);
  transcript.run = std::string(run.model->designation) + run.given.text + with.text;
  if (!preset.empty() && have_different_presets(source.models)) {
    transcript.run += " " + preset;
  }
  transcript.preset = preset_of(*run.model, preset);
  transcript.slow = source.slow;
  transcript.blank_memory = source.blank_memory;
  for (const Line& raw : source.steps) {
    line = raw.number;
    transcript.steps.push_back(parse_step(raw.number, substitute(raw.text, variables), run.model));
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
  Source source;
  if (const std::string table = table_path_for(path); !table.empty()) {
    source.table = read_model_table(table);
  }
  unsigned line = 0;
  try {
    for (std::string raw; std::getline(file, raw);) {
      read_line(raw, ++line, source);
    }
    line = 1;
    if (source.steps.empty()) {
      fail("has no step; add one");
    }
    if (source.models.empty() && source.names_its_source) {
      fail("has 'source:', but names no model; add a 'model:' line, or remove 'source:'");
    }
    if (source.models.empty()) {
      return {scenario(path, source, line)};
    }
    if (!source.names_its_source) {
      fail("has no source; add a line such as 'source: EX9042D manual 2.6'");
    }
    std::vector<Transcript> transcripts;
    const std::vector<Given> once(1);
    for (const ModelRun& run : source.models) {
      for (const Given& with : source.withs.empty() ? once : source.withs) {
        transcripts.push_back(transcript_of(path, source, run, with, line));
      }
    }
    return transcripts;
  } catch (const std::exception& error) {
    fail(path + ":" + std::to_string(line) + ": " + error.what());
  }
}

std::vector<Transcript> load_all(const std::string& path) {
  std::vector<Transcript> all;
  try {
    const bool is_folder = std::filesystem::is_directory(path);
    for (const std::string& file : is_folder ? transcript_files(path) : std::vector<std::string>{path}) {
      for (Transcript& transcript : load(file)) {
        all.push_back(std::move(transcript));
      }
    }
  } catch (const std::filesystem::filesystem_error& error) {
    fail(path + ": " + error.code().message() + "; name a folder that can be read");
  }
  if (all.empty()) {
    fail(path + ": contains no .txt file; name a transcript, a scenario or a folder of such files");
  }
  return all;
}

}  // namespace ex9000::play
