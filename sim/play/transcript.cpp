#include "sim/play/transcript.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <optional>

#include "sim/fail.hpp"
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
};

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  const auto last = text.find_last_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

unsigned long number(const std::string& text, int base = 10) {
  std::size_t used = 0;
  unsigned long value = 0;
  try {
    value = std::stoul(text, &used, base);
  } catch (const std::exception&) {
    used = 0;
  }
  if (text.empty() || used != text.size()) {
    fail("'" + text + "' is no number");
  }
  return value;
}

Bytes hex_bytes(const std::string& text) {
  std::string digits;
  std::copy_if(text.begin(), text.end(), std::back_inserter(digits), [](char c) { return c != ' '; });
  if (digits.empty() || digits.size() % 2 != 0) {
    fail("hex wants pairs of digits");
  }
  Bytes bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(number(digits.substr(i, 2), 16)));
  }
  return bytes;
}

bool on_off(const std::string& text) {
  if (text != "on" && text != "off") {
    fail("'" + text + "' is neither 'on' nor 'off'");
  }
  return text == "on";
}

std::chrono::milliseconds duration(const std::string& text) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(sim::parse_time(text));
}

const Model& model_named(const std::string& name) {
  const Model* model = find_model(name);
  if (model == nullptr) {
    fail("no model '" + name + "'");
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

void apply_preset(const std::string& word, Settings& settings) {
  const auto [key, value] = key_and_value(word);
  const auto format_bit = [&settings](std::uint8_t bit, bool on) {
    settings.format = static_cast<std::uint8_t>(on ? settings.format | bit : settings.format & ~bit);
  };
  if (key == "protocol" && (value == "ascii" || value == "modbus")) {
    settings.protocol = value == "modbus" ? Protocol::ModbusRtu : Protocol::Ascii;
  } else if (key == "address") {
    settings.address = static_cast<std::uint8_t>(number(value, 16));
  } else if (key == "checksum") {
    format_bit(kFormatChecksum, on_off(value));
  } else if (key == "edge" && (value == "rising" || value == "falling")) {
    format_bit(kFormatRisingEdge, value == "rising");
  } else if (key == "baud") {
    const auto* found = std::find(kBaudRates.begin(), kBaudRates.end(), number(value));
    if (found == kBaudRates.end()) {
      fail("no baud rate '" + value + "'");
    }
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

Action parse_action(const std::string& text) {
  const auto rest_after = [&text](std::size_t lead) {
    return text.size() > lead ? text.substr(lead + 1) : std::string();
  };
  if (text[0] == '>') {
    return step::SendDcon{rest_after(1)};
  }
  if (text.rfind("<=", 0) == 0) {
    return step::ExpectModbus{hex_bytes(rest_after(2))};
  }
  if (text[0] == '<') {
    return step::ExpectDcon{rest_after(1)};
  }
  if (text.rfind("=>", 0) == 0) {
    return step::SendModbus{hex_bytes(rest_after(2))};
  }
  const sim::Words word = sim::words_of(text);
  const std::string& verb = word[0];
  const auto takes = [&](std::size_t count) {
    if (word.size() != count + 1) {
      fail("'" + verb + "' has the wrong number of words behind it");
    }
    return true;
  };
  if (verb == "bytes") {
    return step::SendBytes{hex_bytes(rest_after(5))};
  }
  if (verb == "silence" && takes(0)) {
    return step::Silence{};
  }
  if (verb == "wait" && takes(1)) {
    return step::Wait{duration(word[1])};
  }
  if (verb == "checksum" && takes(1)) {
    return step::Checksum{on_off(word[1])};
  }
  if (verb == "baud" && takes(1)) {
    return step::Baud{static_cast<std::uint32_t>(number(word[1]))};
  }
  if (verb == "power" && takes(1)) {
    return step::Power{on_off(word[1])};
  }
  if (verb == "power-cycle" && takes(0)) {
    return step::PowerCycle{};
  }
  if (verb == "reset" && takes(0)) {
    return step::Reset{};
  }
  if (verb == "init" && takes(1)) {
    return step::Init{on_off(word[1])};
  }
  if (verb == "input" && takes(2)) {
    return step::Input{static_cast<unsigned>(number(word[1])), on_off(word[2])};
  }
  if (verb == "pulse" && (word.size() == 2 || (takes(2) && word[2][0] == 'x'))) {
    return step::Pulse{static_cast<unsigned>(number(word[1])),
                       word.size() == 2 ? 1U : static_cast<std::uint32_t>(number(word[2].substr(1)))};
  }
  if (verb == "outputs" && takes(1)) {
    if (word[1].size() > 4) {
      fail("'" + word[1] + "' has more than 16 outputs");
    }
    return step::Outputs{static_cast<std::uint16_t>(number(word[1], 16))};
  }
  if (verb == "led" && takes(1)) {
    if (word[1] == "flashing") {
      return step::Led{step::Led::Shows::Flashing};
    }
    return step::Led{on_off(word[1]) ? step::Led::Shows::On : step::Led::Shows::Off};
  }
  if (verb == "module" && takes(1)) {
    const unsigned long position = number(word[1]);
    if (position == 0) {
      fail("modules count from 1");
    }
    return step::OnModule{position - 1};
  }
  if (verb == "line" && takes(1)) {
    return step::OnLine{word[1]};
  }
  if (verb == "fault" || verb == "faults") {
    return step::Trouble{text};
  }
  fail("no step '" + text + "'");
}

bool is_of_a_bus(const Action& action) {
  return std::holds_alternative<step::OnModule>(action) || std::holds_alternative<step::OnLine>(action) ||
         std::holds_alternative<step::Trouble>(action);
}

/// A channel that the model lacks would be driven in vain.
void check_channel(const Model& model, const Action& action) {
  const auto* input = std::get_if<step::Input>(&action);
  const auto* pulse = std::get_if<step::Pulse>(&action);
  if ((input != nullptr && input->channel >= model.inputs) ||
      (pulse != nullptr && pulse->channel >= model.inputs)) {
    fail("the " + std::string(model.designation) + " has no such input");
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
  sim::Words presets;
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
    ModelRun run{&model_named(word[0]), {}};
    for (std::size_t i = 1; i < word.size(); ++i) {
      run.variables.insert(key_and_value(word[i]));
    }
    source.models.push_back(run);
  } else if (const auto preset = header_value(text, "preset")) {
    source.presets = sim::words_of(*preset);
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
  if (!source.presets.empty() || source.slow) {
    fail(
        "'preset:' and 'tags:' are for files with 'model:'; a scenario's modules have their settings from "
        "its bus");
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
  transcript.preset_given = !source.presets.empty();
  for (const std::string& preset : source.presets) {
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

std::chrono::milliseconds Transcript::waits() const {
  std::chrono::milliseconds total{0};
  for (const Step& step : steps) {
    if (const auto* wait = std::get_if<step::Wait>(&step.action)) {
      total += wait->time;
    } else if (std::holds_alternative<step::Silence>(step.action)) {
      total += kSilence;
    }
  }
  return total;
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
