#include "sim/app/play/transcript.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>

#include "sim/files_and_ports/files/regular_file.hpp"
#include "sim/front_ends/control_socket/control.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::play {

namespace {

using sim::fail;
using sim::open_text_file;
using sim::parse_hex_byte;
using sim::parse_hex_bytes;
using sim::parse_hex_word;
using sim::parse_on_off;
using sim::parse_whole_number;
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

/// Parses a channel number. Does not check whether the model has this channel.
unsigned channel(const std::string& text) {
  constexpr unsigned long kMostChannels = 16;
  return static_cast<unsigned>(parse_whole_number(text, 0, kMostChannels - 1));
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

Action outputs(const sim::Words& words) { return step::Outputs{parse_hex_word(words[0])}; }

Action pulse(const sim::Words& words) {
  std::uint32_t count = 1;
  if (words.size() == 2) {
    if (words[1][0] != 'x') {
      fail("'" + words[1] + "': expected a count with an x before it, for example x5");
    }
    count = static_cast<std::uint32_t>(parse_whole_number(words[1].substr(1), 1, sim::kMostPulses));
  }
  return step::Pulse{channel(words[0]), count};
}

Action led(const sim::Words& words) {
  using Shows = step::Led::Shows;
  for (const auto& [word, shows] :
       {std::pair("on", Shows::On), std::pair("off", Shows::Off), std::pair("flashing", Shows::Flashing)}) {
    if (words[0] == word) {
      return step::Led{shows};
    }
  }
  fail("'" + words[0] + "': expected on, off or flashing");
}

/// A step that begins with a keyword.
struct Verb {
  std::string_view name;
  std::string_view args;
  std::size_t fewest;
  std::size_t most;
  Action (*action)(const sim::Words& words);  ///< creates the action from the words after the name

  [[nodiscard]] std::string shape() const {
    return std::string(name) + (args.empty() ? "" : " ") + std::string(args);
  }
};

using sim::Words;

constexpr std::size_t kAnyNumber = 1000;
constexpr unsigned long kMostModules = 999'999;

constexpr std::array<Verb, 18> kVerbs{{
    {"bytes", "HEX", 1, kAnyNumber,
     [](const Words& words) -> Action { return step::SendBytes{parse_hex_bytes(sim::joined(words))}; }},
    {"silence", "", 0, 0, [](const Words& /*words*/) -> Action { return step::Silence{}; }},
    {"wait", "TIME", 1, 1,
     [](const Words& words) -> Action { return step::Wait{sim::parse_time(words[0])}; }},
    {"checksum", "on|off", 1, 1,
     [](const Words& words) -> Action { return step::Checksum{parse_on_off(words[0])}; }},
    {"baud", "RATE", 1, 1,
     [](const Words& words) -> Action { return step::Baud{sim::parse_baud_rate(words[0])}; }},
    {"format", "8N1|8N2|8E1|8O1", 1, 1,
     [](const Words& words) -> Action { return step::Format{sim::parse_line_format(words[0])}; }},
    {"power", "on|off", 1, 1,
     [](const Words& words) -> Action { return step::Power{parse_on_off(words[0])}; }},
    {"power-cycle", "", 0, 0, [](const Words& /*words*/) -> Action { return step::PowerCycle{}; }},
    {"reset", "", 0, 0, [](const Words& /*words*/) -> Action { return step::Reset{}; }},
    {"init", "on|off", 1, 1, [](const Words& words) -> Action { return step::Init{parse_on_off(words[0])}; }},
    {"input", "C on|off", 2, 2,
     [](const Words& words) -> Action {
       return step::Input{channel(words[0]), parse_on_off(words[1])};
     }},
    {"pulse", "C [xCOUNT]", 1, 2, pulse},
    {"outputs", "HHHH", 1, 1, outputs},
    {"led", "on|off|flashing", 1, 1, led},
    {"module", "N", 1, 1,
     [](const Words& words) -> Action {
       return step::OnModule{parse_whole_number(words[0], 1, kMostModules) - 1};
     }},
    {"line", "NAME", 1, 1, [](const Words& words) -> Action { return step::OnLine{words[0]}; }},
    {"fault", "[N] FAULT, or fault off K|all", 1, kAnyNumber,
     [](const Words& words) -> Action { return step::FaultCommand{"fault " + sim::joined(words)}; }},
    {"faults", "", 0, 0, [](const Words& /*words*/) -> Action { return step::FaultCommand{"faults"}; }},
}};

std::string all_shapes() {
  std::string text = "> TEXT, < TEXT, => HEX, <= HEX";
  for (const Verb& verb : kVerbs) {
    text += ", " + verb.shape();
  }
  return text;
}

Action parse_verb(const std::string& text) {
  Words words = sim::words_of(text);
  const std::string name = words[0];
  words.erase(words.begin());
  for (const Verb& verb : kVerbs) {
    if (verb.name == name && (words.size() < verb.fewest || words.size() > verb.most)) {
      fail("'" + text + "': expected " + verb.shape());
    }
    if (verb.name == name) {
      return verb.action(words);
    }
  }
  fail("'" + text + "' is not a step; expected one of " + all_shapes());
}

/// Parses `HEX` or `HEX or HEX ...`.
Action parse_modbus_reply(const std::string& text) {
  const std::string separator = " or ";
  step::ExpectModbus expected;
  std::size_t from = 0;
  for (std::size_t end = 0; end != std::string::npos; from = end + separator.size()) {
    end = text.find(separator, from);
    expected.frames.push_back(
        parse_hex_bytes(text.substr(from, end == std::string::npos ? end : end - from)));
    if (expected.frames.back().size() != expected.frames.front().size()) {
      fail("'" + text + "': the replies differ in length; expected replies of the same length");
    }
  }
  return expected;
}

[[noreturn]] void reject_without_blank(const std::string& text, const std::string& lead) {
  fail("'" + text + "': expected a blank after " + lead);
}

Action parse_action(const std::string& text) {
  for (const std::string lead : {"<=", "=>", "<", ">"}) {
    if (text.rfind(lead, 0) != 0) {
      continue;
    }
    std::string rest = text.substr(lead.size());
    if (!rest.empty() && rest[0] != ' ' && rest[0] != '\t') {
      reject_without_blank(text, lead);
    }
    rest.erase(0, 1);
    if (lead == "<=") {
      return parse_modbus_reply(rest);
    }
    if (lead == "=>") {
      return step::SendModbus{parse_hex_bytes(rest)};
    }
    return lead == "<" ? Action(step::ExpectDcon{rest}) : Action(step::SendDcon{rest});
  }
  return parse_verb(text);
}

bool requires_bus(const Action& action) {
  return std::holds_alternative<step::OnModule>(action) || std::holds_alternative<step::OnLine>(action) ||
         std::holds_alternative<step::FaultCommand>(action);
}

/// Rejects a step that uses an input that the model lacks.
void check_channel(const Model& model, const Action& action) {
  const auto* input = std::get_if<step::Input>(&action);
  const auto* pulse = std::get_if<step::Pulse>(&action);
  if (input != nullptr || pulse != nullptr) {
    const std::string flaw = missing_input(model, input != nullptr ? input->channel : pulse->channel);
    if (!flaw.empty()) {
      fail(flaw);
    }
  }
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
    transcript.steps.push_back({raw.number, raw.text, parse_action(raw.text)});
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
    transcript.steps.push_back({raw.number, text, parse_action(text)});
    check_channel(*run.model, transcript.steps.back().action);
    if (requires_bus(transcript.steps.back().action)) {
      fail("'" + text + "': only scenarios have this step; remove the step or the 'model:' lines");
    }
  }
  return transcript;
}

}  // namespace

std::string missing_input(const Model& model, unsigned channel) {
  if (channel < model.inputs) {
    return "";
  }
  const std::string name(model.designation);
  return "the " + name +
         (model.inputs == 0 ? " has no inputs; choose a module with inputs or remove the step"
                            : " has no input " + std::to_string(channel) + "; it has 0 to " +
                                  std::to_string(model.inputs - 1));
}

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
