#include "sim/play/transcript.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

#include "sim/control/control.hpp"
#include "sim/fail.hpp"
#include "sim/setup.hpp"
#include "sim/time_text.hpp"
#include "sim/words.hpp"

namespace ex9000::play {

namespace {

using sim::fail;
using Variables = std::map<std::string, std::string>;

struct Line {
  unsigned number;
  std::string text;
};

struct ModelRun {
  const Model* model;
  Variables variables;
  sim::Words presets;
};

bool is_blank(char character) { return character == ' ' || character == '\t'; }

bool are_hex_digits(const std::string& text) {
  return text.find_first_not_of("0123456789ABCDEFabcdef") == std::string::npos;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  const auto last = text.find_last_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

constexpr int kHex = 16;

/// Digits and nothing else, and not too many of them.
std::optional<unsigned long> digits(const std::string& text, int base) {
  unsigned long value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value, base);
  return error != std::errc() || rest != end ? std::nullopt : std::optional(value);
}

unsigned long number(const std::string& text, unsigned long least, unsigned long most) {
  const auto value = digits(text, 10);
  if (!value || *value < least || *value > most) {
    fail("'" + text + "' wants a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  }
  return *value;
}

Bytes hex_bytes(const std::string& text) {
  std::string all;
  std::copy_if(text.begin(), text.end(), std::back_inserter(all), [](char c) { return !is_blank(c); });
  if (all.empty() || all.size() % 2 != 0 || !are_hex_digits(all)) {
    fail("'" + text + "' wants pairs of hex digits, such as 01 05 00FF");
  }
  Bytes bytes;
  for (std::size_t i = 0; i < all.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(*digits(all.substr(i, 2), kHex)));
  }
  return bytes;
}

bool on_off(const std::string& text) {
  if (text != "on" && text != "off") {
    fail("'" + text + "' is neither 'on' nor 'off'");
  }
  return text == "on";
}

std::string joined(const sim::Words& words) {
  std::string text;
  for (const std::string& word : words) {
    text += (text.empty() ? "" : " ") + word;
  }
  return text;
}

/// Which of them a model has is seen where that is known.
unsigned channel(const std::string& text) {
  constexpr unsigned long kMostChannels = 16;
  return static_cast<unsigned>(number(text, 0, kMostChannels - 1));
}

const Model& model_named(const std::string& name) {
  const Model* model = find_model(name);
  if (model == nullptr) {
    fail("no model '" + name + "'; --models lists them");
  }
  return *model;
}

std::pair<std::string, std::string> key_and_value(const std::string& word) {
  const auto equals = word.find('=');
  if (equals == std::string::npos) {
    fail("'" + word + "' wants KEY=VALUE");
  }
  return {word.substr(0, equals), word.substr(equals + 1)};
}

std::uint8_t preset_address(const std::string& text) {
  if (text.empty() || text.size() > 2 || !are_hex_digits(text)) {
    fail("'address=" + text + "' wants one or two hex digits");
  }
  return static_cast<std::uint8_t>(*digits(text, kHex));
}

void apply_preset(const std::string& word, Settings& settings) {
  const auto [key, value] = key_and_value(word);
  const auto format_bit = [&settings](std::uint8_t bit, bool on) {
    settings.format = static_cast<std::uint8_t>(on ? settings.format | bit : settings.format & ~bit);
  };
  if (key == "protocol" && (value == "ascii" || value == "modbus")) {
    settings.protocol = value == "modbus" ? Protocol::ModbusRtu : Protocol::Ascii;
  } else if (key == "address") {
    settings.address = preset_address(value);
  } else if (key == "checksum") {
    format_bit(kFormatChecksum, on_off(value));
  } else if (key == "edge" && (value == "rising" || value == "falling")) {
    format_bit(kFormatRisingEdge, value == "rising");
  } else if (key == "baud") {
    const auto* found = std::find(kBaudRates.begin(), kBaudRates.end(), sim::parse_line_rate(value));
    settings.baud_code = static_cast<std::uint8_t>(kFirstBaudCode + (found - kBaudRates.begin()));
  } else {
    fail("no preset '" + word + "'");
  }
}

std::string substitute(std::string text, const Variables& variables) {
  for (const auto& [name, value] : variables) {
    const std::string pattern = "{" + name + "}";
    for (auto at = text.find(pattern); at != std::string::npos; at = text.find(pattern, at + value.size())) {
      text.replace(at, pattern.size(), value);
    }
  }
  return text;
}

Action outputs(const sim::Words& words) {
  constexpr std::size_t kMostDigits = 4;
  if (words[0].size() > kMostDigits || !are_hex_digits(words[0])) {
    fail("'" + words[0] + "' wants 1 to 4 hex digits, bit n is output n");
  }
  return step::Outputs{static_cast<std::uint16_t>(*digits(words[0], kHex))};
}

Action pulse(const sim::Words& words) {
  std::uint32_t count = 1;
  if (words.size() == 2) {
    if (words[1][0] != 'x') {
      fail("'" + words[1] + "' wants an x before the count, such as x5");
    }
    count = static_cast<std::uint32_t>(number(words[1].substr(1), 1, sim::kMostPulses));
  }
  return step::Pulse{channel(words[0]), count};
}

Action led(const sim::Words& words) {
  if (words[0] == "flashing") {
    return step::Led{step::Led::Shows::Flashing};
  }
  return step::Led{on_off(words[0]) ? step::Led::Shows::On : step::Led::Shows::Off};
}

/// A step that begins with a word.
struct Verb {
  std::string_view name;
  std::string_view args;
  std::size_t fewest;
  std::size_t most;
  Action (*action)(const sim::Words& words);  ///< of what stands behind it

  [[nodiscard]] std::string shape() const {
    return std::string(name) + (args.empty() ? "" : " ") + std::string(args);
  }
};

using sim::Words;

constexpr std::size_t kAnyNumber = 1000;
constexpr unsigned long kMostModules = 999'999;

constexpr std::array<Verb, 17> kVerbs{{
    {"bytes", "HEX", 1, kAnyNumber,
     [](const Words& words) -> Action { return step::SendBytes{hex_bytes(joined(words))}; }},
    {"silence", "", 0, 0, [](const Words& /*words*/) -> Action { return step::Silence{}; }},
    {"wait", "TIME", 1, 1,
     [](const Words& words) -> Action { return step::Wait{sim::parse_time(words[0])}; }},
    {"checksum", "on|off", 1, 1,
     [](const Words& words) -> Action { return step::Checksum{on_off(words[0])}; }},
    {"baud", "RATE", 1, 1,
     [](const Words& words) -> Action { return step::Baud{sim::parse_line_rate(words[0])}; }},
    {"power", "on|off", 1, 1, [](const Words& words) -> Action { return step::Power{on_off(words[0])}; }},
    {"power-cycle", "", 0, 0, [](const Words& /*words*/) -> Action { return step::PowerCycle{}; }},
    {"reset", "", 0, 0, [](const Words& /*words*/) -> Action { return step::Reset{}; }},
    {"init", "on|off", 1, 1, [](const Words& words) -> Action { return step::Init{on_off(words[0])}; }},
    {"input", "C on|off", 2, 2,
     [](const Words& words) -> Action {
       return step::Input{channel(words[0]), on_off(words[1])};
     }},
    {"pulse", "C [xCOUNT]", 1, 2, pulse},
    {"outputs", "HHHH", 1, 1, outputs},
    {"led", "on|off|flashing", 1, 1, led},
    {"module", "N", 1, 1,
     [](const Words& words) -> Action { return step::OnModule{number(words[0], 1, kMostModules) - 1}; }},
    {"line", "NAME", 1, 1, [](const Words& words) -> Action { return step::OnLine{words[0]}; }},
    {"fault", "[N] FAULT, or fault off K|all", 1, kAnyNumber,
     [](const Words& words) -> Action { return step::Trouble{"fault " + joined(words)}; }},
    {"faults", "", 0, 0, [](const Words& /*words*/) -> Action { return step::Trouble{"faults"}; }},
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
      fail("'" + text + "': the step is " + verb.shape());
    }
    if (verb.name == name) {
      return verb.action(words);
    }
  }
  fail("no step '" + text + "'; there are " + all_shapes());
}

Action parse_action(const std::string& text) {
  for (const std::string lead : {"<=", "=>", "<", ">"}) {
    if (text.rfind(lead, 0) != 0) {
      continue;
    }
    if (text.size() > lead.size() && !is_blank(text[lead.size()])) {
      std::string what = "'" + text + "' wants a blank behind ";
      what += lead;
      fail(what);
    }
    const std::string rest = text.size() > lead.size() ? text.substr(lead.size() + 1) : "";
    if (lead == "<=") {
      return step::ExpectModbus{hex_bytes(rest)};
    }
    if (lead == "=>") {
      return step::SendModbus{hex_bytes(rest)};
    }
    return lead == "<" ? Action(step::ExpectDcon{rest}) : Action(step::SendDcon{rest});
  }
  return parse_verb(text);
}

bool is_of_a_bus(const Action& action) {
  return std::holds_alternative<step::OnModule>(action) || std::holds_alternative<step::OnLine>(action) ||
         std::holds_alternative<step::Trouble>(action);
}

/// A channel that the model lacks would be driven in vain.
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

/// What is written of a file, before it is bound to a model.
struct Source {
  bool names_its_source = false;
  bool slow = false;
  std::vector<ModelRun> models;
  std::size_t preset_ends = 0;  ///< the first of `models` that no preset line has been read for
  std::vector<Line> steps;
};

bool read_header(const std::string& text, Source& source) {
  if (const auto from = header_value(text, "source")) {
    source.names_its_source = !from->empty();
  } else if (const auto model = header_value(text, "model")) {
    const sim::Words word = sim::words_of(*model);
    if (word.empty()) {
      fail("'model:' wants a name");
    }
    ModelRun run{&model_named(word[0]), {}, {}};
    for (std::size_t i = 1; i < word.size(); ++i) {
      run.variables.insert(key_and_value(word[i]));
    }
    source.models.push_back(run);
  } else if (const auto preset = header_value(text, "preset")) {
    if (source.preset_ends == source.models.size()) {
      fail("'preset:' requires a 'model:' line above it, which has no preset yet");
    }
    for (; source.preset_ends < source.models.size(); ++source.preset_ends) {
      source.models[source.preset_ends].presets = sim::words_of(*preset);
    }
  } else if (const auto tags = header_value(text, "tags")) {
    if (*tags != "slow") {
      fail("no tag '" + *tags + "'");
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
  if (source.steps.empty() && read_header(text, source)) {
    return;
  }
  source.steps.push_back({number, text});
}

Transcript scenario(const std::string& path, const Source& source, unsigned& line) {
  if (source.slow) {
    fail("'tags:' is for files with 'model:'");
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
  transcript.preset = Settings::factory(*run.model);
  transcript.preset_given = !run.presets.empty();
  for (const std::string& preset : run.presets) {
    apply_preset(preset, transcript.preset);
  }
  transcript.slow = source.slow;
  for (const Line& raw : source.steps) {
    line = raw.number;
    const std::string text = substitute(raw.text, run.variables);
    transcript.steps.push_back({raw.number, text, parse_action(text)});
    check_channel(*run.model, transcript.steps.back().action);
    if (is_of_a_bus(transcript.steps.back().action)) {
      fail("'" + text + "' is for scenarios, which have a bus and no 'model:'");
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
         (model.inputs == 0 ? " has no inputs; name a module that has, or leave the step out"
                            : " has no input " + std::to_string(channel) + "; it has 0 to " +
                                  std::to_string(model.inputs - 1));
}

std::chrono::milliseconds Transcript::waits() const {
  std::chrono::nanoseconds total{0};
  for (const Step& step : steps) {
    if (const auto* wait = std::get_if<step::Wait>(&step.action)) {
      total += wait->time;
    } else if (std::holds_alternative<step::Silence>(step.action)) {
      total += kSilence;
    }
  }
  return std::chrono::ceil<std::chrono::milliseconds>(total);
}

std::vector<std::string> transcript_files(const std::string& directory) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory)) {
    if (entry.path().extension() == ".txt") {
      files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<Transcript> load(const std::string& path) {
  std::ifstream file(path);
  if (!file) {
    fail(path + ": cannot be read");
  }
  unsigned line = 0;
  try {
    Source source;
    for (std::string raw; std::getline(file, raw);) {
      ++line;
      if (!raw.empty()) {
        read_line(raw, line, source);
      }
    }
    line = 1;
    if (source.steps.empty()) {
      fail("wants a step");
    }
    if (source.models.empty()) {
      return {scenario(path, source, line)};
    }
    if (!source.names_its_source) {
      fail("wants 'source:'");
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

std::vector<Transcript> load_transcripts(const std::string& path) {
  std::vector<Transcript> transcripts = load(path);
  if (transcripts[0].model == nullptr) {
    fail(path + ":1: wants at least one 'model:'");
  }
  return transcripts;
}

}  // namespace ex9000::play
