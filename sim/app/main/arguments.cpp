#include "sim/app/main/arguments.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sim/app/main/help.hpp"
#include "sim/app/main/line_options.hpp"
#include "sim/app/main/option_values.hpp"
#include "sim/app/model_exports/describe.hpp"
#include "sim/app/setup_from_bus_file/bus_file.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

constexpr const char* kDescription =
    "Simulated EX9000 modules on RS-485 lines, for Modbus and DCON masters: on a pseudo-terminal, over TCP, "
    "or on a real serial port.";

constexpr const char* kDefaultPty = "ex9000.tty";
/// The value of --panel if the user gives the option without a value.
constexpr const char* kUsualPort = "usual";

std::string list_models() {
  std::string text;
  for (const Model& model : kModels) {
    std::string name(model.designation);
    name.resize(12, ' ');
    text += name + (model.speaks_modbus() ? "ASCII, Modbus RTU  " : "ASCII              ") +
            std::string(model.description) + "\n";
  }
  return text;
}

Parsed wrong(const std::string& what) {
  Parsed parsed;
  parsed.error = "ex9000-sim: " + one_line(what) + "\n";
  parsed.exit_status = kWrongArguments;
  return parsed;
}

struct WritingTexts {
  std::optional<std::string> log;
  std::optional<std::string> capture;
};

/// The arguments that define a Setup, as text.
struct Texts {
  LineTexts line;
  std::optional<std::string> control;
  std::optional<std::string> speed;
  std::optional<std::string> threads;
  std::optional<std::string> lasts;
  std::optional<std::string> seed;
  std::optional<std::string> panel;
  bool watch = false;
  WritingTexts writing;
};

void apply_writing(const WritingTexts& texts, Writing& writing) {
  take_option("--log", texts.log, parse_log, writing.log);
  if (texts.capture) {
    writing.capture = texts.capture;
  }
}

/// Returns the prefix of the error message. If the wrong value is in the bus file, the prefix is the place of
/// its key there. Otherwise the prefix is the option of the command line, or `eeprom=` for the EEPROM file of
/// a module.
std::string where(const SetupError& error, const Setup& setup) {
  if (error.module) {
    return setup.lines[*error.line].modules[*error.module].eeprom_place;
  }
  const Places& places = error.line ? setup.lines[*error.line].places : setup.places;
  const auto place = places.find(error.key);
  if (place != places.end()) {
    return place->second + ": ";
  }
  return "--" + error.key + ": ";
}

/// Returns the text with which a message refers to a key: `'KEY'VALUE in FILE` if the bus file contains the
/// key, otherwise the option of the command line, `--KEYVALUE`. `value` is empty or begins with a space.
std::string name_of(const std::string& key, const std::string& value, const Setup& setup) {
  const auto has_key = [&key](const auto& part) { return part.places.count(key) != 0; };
  const bool in_file = has_key(setup) || std::any_of(setup.lines.begin(), setup.lines.end(), has_key);
  return in_file ? "'" + key + "'" + value + " in " + setup.file : "--" + key + value;
}

std::optional<PanelSetup> parse_panel_option(const std::string& text) {
  return parse_panel(text == kUsualPort ? "" : text);
}

/// Applies the options that belong to the program, not to a line. An option overrides the key with the same
/// name if the bus file contains this key.
void apply_options(const Texts& texts, Setup& setup) {
  take_option("--speed", texts.speed, parse_speed, setup.speed);
  take_option("--threads", texts.threads, parse_threads, setup.threads);
  take_option("--for", texts.lasts, parse_time, setup.lasts);
  take_option("--seed", texts.seed, parse_seed, setup.seed);
  take_option("--panel", texts.panel, parse_panel_option, setup.panel);
  apply_writing(texts.writing, setup);
  setup.control = texts.control ? texts.control : setup.control;
  setup.watch = texts.watch || setup.watch;
  const std::pair<const char*, bool> given[] = {{"control", texts.control.has_value()},
                                                {"watch", texts.watch},
                                                {"panel", texts.panel.has_value()},
                                                {"log", texts.writing.log.has_value()},
                                                {"capture", texts.writing.capture.has_value()}};
  for (const auto& [key, is_given] : given) {
    if (is_given) {
      setup.places.erase(key);
    }
  }
}

/// Returns the setup that the arguments describe. Reads the bus file if the arguments name one, and calls
/// `check`. Throws std::invalid_argument with a one-line message.
Setup setup_of(const Texts& texts) {
  if (texts.line.modules.empty()) {
    fail("no module given; try 'ex9000-sim EX9042D-M' or --help");
  }
  Setup setup;
  const std::vector<std::string>& arguments = texts.line.modules;
  const auto bus_file = std::find_if(arguments.begin(), arguments.end(), is_bus_file);
  if (bus_file != arguments.end()) {
    reject_line_options(*bus_file, texts.line);
    setup = read_bus_file(*bus_file);
    setup.file = *bus_file;
  } else {
    setup.lines.push_back(line_of(texts.line));
  }
  apply_options(texts, setup);
  for (LineSetup& line : setup.lines) {
    if (line.first_port().empty() && !line.serial && !setup.speed.max()) {
      line.pty = line.name.empty() ? kDefaultPty : line.name + ".tty";
    }
  }
  try {
    check(setup);
  } catch (const SetupError& error) {
    fail(where(error, setup) + error.named([&](const std::string& key, const std::string& value) {
      return name_of(key, value, setup);
    }));
  }
  return setup;
}

void add_writing(CLI::App& app, WritingTexts& texts) {
  app.add_option(
         "--log", texts.log,
         "print each frame on the bus as one line of text: time, direction, bytes, meaning; json: print only "
         "JSON objects on standard output, one for each frame and each note")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)  // a later --log overrides one in a script
      ->type_name("[text|json|off]");
  app.add_option("--capture", texts.capture,
                 "write the frames to this pcapng file for Wireshark; an existing file is overwritten")
      ->type_name("FILE");
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

/// Returns the arguments with `=` and a value appended to each word `--log` or `--panel`. The value is the
/// next word if that word can be a value of the option, otherwise `text` for --log and kUsualPort for
/// --panel. CLI11 itself would take any next word as the value, even if that word is a module.
std::vector<std::string> with_optional_values(int argc, const char* const* argv) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    words.emplace_back(argv[i]);
    const std::string next = i + 1 < argc ? argv[i + 1] : "";
    const bool log = words.back() == "--log";
    const bool panel = words.back() == "--panel";
    if (log || panel) {
      const bool named = next == "off" || (log ? next == "text" || next == "json" : is_number(next));
      words.back() += named ? "=" + next : log ? "=text" : std::string("=") + kUsualPort;
      i += named ? 1 : 0;
    }
  }
  return words;
}

[[noreturn]] void refuse_missing_value(const std::string& option, const std::string& value,
                                       const std::string& next) {
  fail(option + ": the value is missing before " + next.substr(0, next.find('=')) + "; expected " + option +
       " " + value);
}

/// Rejects an option without its value if the next word is an option too, because CLI11 would take that word
/// as the value. `--NAME=VALUE` permits any value. Throws std::invalid_argument with a one-line message.
void reject_missing_values(const CLI::App& app, const std::vector<std::string>& words) {
  std::vector<const CLI::App*> apps =
      app.get_subcommands([](const CLI::App* /*subcommand*/) { return true; });
  apps.insert(apps.begin(), &app);
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const std::string& word = words[i];
    const std::string& next = words[i + 1];
    for (const CLI::App* each : apps) {
      const CLI::Option* option = word.rfind("--", 0) == 0 ? each->get_option_no_throw(word) : nullptr;
      if (option != nullptr && option->get_items_expected_min() > 0 && next.rfind("--", 0) == 0) {
        refuse_missing_value(word, option->get_type_name(), next);
      }
    }
  }
}

struct PlayTexts {
  std::string file;
  Texts bus;  ///< without the texts about writing
  WritingTexts writing;
};

const CLI::App* add_play(CLI::App& app, PlayTexts& texts) {
  CLI::App* const play = app.add_subcommand("play",
                                            "play transcripts or scenarios in virtual time; exit with 0 if "
                                            "all steps pass, with 2 if an argument or a file is wrong, else "
                                            "with 1");
  play->footer(help::of_play());
  play->add_option("FILE", texts.file, "the file, or a folder of such files")->required();
  play->add_option("MODULE", texts.bus.line.modules, "for a scenario: the modules, or BUS.json");
  play->add_option("--seed", texts.bus.seed, "set the seed of random faults and bouncing inputs (default: 1)")
      ->type_name("NUMBER");
  add_writing(*play, texts.writing);
  return play;
}

play::Task task_of(const PlayTexts& texts) {
  play::Task task;
  task.path = texts.file;
  apply_writing(texts.writing, task.writing);
  if (texts.bus.seed) {
    of_option("--seed", *texts.bus.seed, parse_seed);  // reject a wrong seed even if the seed has no effect
  }
  if (task.writing.capture && task.writing.capture->empty()) {
    fail("--capture: is empty; name a path");
  }
  if (!texts.bus.line.modules.empty()) {
    task.bus = setup_of(texts.bus);
  }
  return task;
}

CLI::App* add_describe(CLI::App& app, DescribeTexts& texts) {
  CLI::App* const describe = app.add_subcommand(
      "describe", "print the commands and registers of one model or of all models, and exit");
  describe->footer(help::of_describe());
  describe->add_option("MODEL", texts.model,
                       "a name from --models, in upper or lower case, with or without EX");
  describe
      ->add_option("--format", texts.format,
                   "set the format: markdown (default), json and csv describe one model or all models; each "
                   "other format is for the tool with the same name and requires a model that speaks Modbus")
      ->type_name(describe_formats());
  describe
      ->add_option("--address", texts.address,
                   "name the module's Modbus address in hex, for home-assistant and node-red (default: 01)")
      ->type_name("HH");
  describe
      ->add_option(
          "--tcp", texts.tcp,
          "name the TCP port of the simulator, for home-assistant and node-red (default: 127.0.0.1:5020)")
      ->type_name("HOST:PORT");
  describe
      ->add_option("--modbus-tcp", texts.modbus_tcp,
                   "name the Modbus TCP port of the simulator, in place of --tcp, for the same formats")
      ->type_name("HOST:PORT");
  return describe;
}

Parsed printed(const std::string& text) {
  Parsed parsed;
  parsed.output = text;
  return parsed;
}

/// Returns the options and positional arguments that the user gave for `app` itself, not for a subcommand, in
/// the order in which they were added to `app`.
std::vector<const CLI::Option*> given_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->count() != 0; });
}

/// Returns the name of an option. A positional argument has no such name. If `option` is positional, the
/// result is its first value, as the user wrote it.
std::string name_of(const CLI::Option& option) {
  return option.get_positional() ? option.results().front() : option.get_name();
}

/// Rejects arguments before a subcommand, because they would have no effect. Throws std::invalid_argument
/// with a one-line message.
void reject_arguments_before(const CLI::App& subcommand, const CLI::App& app) {
  const std::vector<const CLI::Option*> given = given_of(app);
  if (given.empty()) {
    return;
  }
  const CLI::Option& option = *given.front();
  const std::string& name = subcommand.get_name();
  const bool may_come_after =
      option.get_positional() ? name == "play" : subcommand.get_option_no_throw(option.get_name()) != nullptr;
  fail(name + ": " + name_of(option) + " comes before the subcommand" +
       (may_come_after ? "; move it after '" + name + "'"
                       : ", where it has no effect; leave it out, or see 'ex9000-sim " + name + " --help'"));
}

/// Rejects all arguments except `printing`, an option that prints text and runs nothing. Throws
/// std::invalid_argument with a one-line message.
void reject_other_arguments(const std::string& printing, const CLI::App& app) {
  for (const CLI::Option* option : given_of(app)) {
    if (option->get_name() != printing) {
      fail(printing + ": only prints text; leave out " + name_of(*option));
    }
  }
  if (!app.get_subcommands().empty()) {
    fail(printing + ": only prints text; leave out " + app.get_subcommands().front()->get_name());
  }
}

}  // namespace

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

Parsed parse_arguments(int argc, const char* const* argv) {
  CLI::App app(kDescription, "ex9000-sim");
  app.footer(help::of_the_program());
  Texts texts;
  bool models = false;
  bool example = false;
  bool schema = false;
  app.add_option("MODULE", texts.line.modules, "the modules on the line, or BUS.json");
  app.add_option("--pty", texts.line.pty,
                 std::string("create a pseudo-terminal, and a link to it at this path (default: ") +
                     kDefaultPty + " if none of --tcp, --modbus-tcp, --serial and --speed max is given)")
      ->type_name("LINK");
  app.add_option("--pty-access", texts.line.pty_access,
                 "set the mode and the group of the pseudo-terminal, for example 660:dialout")
      ->type_name("MODE[:GROUP]");
  app.add_option("--tcp", texts.line.tcp, "serve the line's bytes over TCP (default HOST: 127.0.0.1)")
      ->type_name("[HOST:]PORT");
  app.add_option("--modbus-tcp", texts.line.modbus_tcp,
                 "open a Modbus TCP gateway to the Modbus modules of the line (default HOST: 127.0.0.1)")
      ->type_name("[HOST:]PORT");
  app.add_option("--modbus-timeout", texts.line.modbus_timeout,
                 "set how long the gateway waits for a reply, plus the time that the line needs (default: "
                 "200ms)")
      ->type_name("TIME");
  app.add_option("--serial", texts.line.serial, "connect the modules to a real line through this serial port")
      ->type_name("DEVICE");
  app.add_flag("--echo", texts.line.echo, "ignore the echo of a serial adapter that receives what it sends");
  app.add_option(
         "--baud", texts.line.baud,
         "set the line's baud rate at the start; a master on a pseudo-terminal can change it (default: the "
         "first module's)")
      ->type_name("RATE");
  app.add_option("--format", texts.line.format,
                 "set the line's format: 8N1, 8N2, 8E1 or 8O1 (default: the first module's)")
      ->type_name("FORMAT");
  app.add_option("--line", texts.line.kind,
                 "set how long bytes take; paced (default): as long as on a real line; instant: no time")
      ->type_name("paced|instant");
  app.add_option("--control", texts.control, "create a UNIX socket for commands at this path")
      ->type_name("PATH");
  app.add_option(
         "--panel", texts.panel,
         "serve, for browsers on this computer, a page with the modules and the frames (default port: "
         "9042, or any free port if port 9042 is in use)")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
      ->type_name("[PORT|off]");
  app.add_flag("--watch", texts.watch,
               "show the modules in the terminal; print a line for each change if standard output is not a "
               "terminal");
  app.add_option("--input", texts.line.inputs,
                 "let an input change by itself, for example '2 0 square 100ms'; see below")
      ->type_name("'N INPUT'")
      ->allow_extra_args(false);
  app.add_option("--fault", texts.line.faults,
                 "add a fault, for example 'bit-errors 1e-4' or '2 lost-reply every 10th reply'; see below")
      ->type_name("'[N] FAULT'")
      ->allow_extra_args(false);
  app.add_option("--speed", texts.speed,
                 "run N times as fast as the wall clock, 0.001 to 1000 (default: 1); max: as fast as "
                 "possible; requires --for, and cannot be combined with a port, --control or --panel; step: "
                 "only the control command 'advance' advances the time; requires --control")
      ->type_name("N|max|step");
  app.add_option(
         "--threads", texts.threads,
         "run the lines of a bus file on at most N threads (default: one for each processor, up to 64)")
      ->type_name("N");
  app.add_option("--for", texts.lasts, "end when this time has passed on the lines, for example 10s or 24h")
      ->type_name("TIME");
  app.add_option("--seed", texts.seed,
                 "set the seed of random faults and bouncing inputs; the same seed repeats them (default: 1)")
      ->type_name("NUMBER");
  add_writing(app, texts.writing);
  app.add_flag("--strict-gaps", texts.line.strict_gaps,
               "make modules ignore a Modbus frame with a gap of more than 1.5 characters, and do not insert "
               "the silence that a master omits between frames");
  app.add_flag("--example", example, "print an example of a bus file and exit");
  app.add_flag("--schema", schema, "print the JSON Schema of bus files and exit");
  app.add_flag("--models", models, "list the models and exit");
  app.require_subcommand(0, 1);  // with the limit 1, `play describe` plays the file `describe`
  PlayTexts play_texts;
  const CLI::App* const playing = add_play(app, play_texts);
  DescribeTexts describe_texts;
  const CLI::App* const describing = add_describe(app, describe_texts);
  app.set_version_flag("--version", "ex9000-sim " + std::string(kFirmwareVersion));
  try {
    std::vector<std::string> words = with_optional_values(argc, argv);
    reject_missing_values(app, words);
    std::reverse(words.begin(), words.end());  // CLI11 expects the last word first
    app.parse(words);
  } catch (const CLI::CallForHelp&) {
    return printed(app.help("", CLI::AppFormatMode::All));
  } catch (const CLI::CallForVersion& version) {
    return printed(std::string(version.what()) + "\n");
  } catch (const CLI::ParseError& error) {
    return wrong(std::string(error.what()) + "; see --help");
  } catch (const std::invalid_argument& error) {
    return wrong(error.what());
  }
  try {
    if (models) {
      reject_other_arguments("--models", app);
      return printed(list_models());
    }
    if (example) {
      reject_other_arguments("--example", app);
      return printed(example_bus_file());
    }
    if (schema) {
      reject_other_arguments("--schema", app);
      return printed(bus_file_schema());
    }
    for (const CLI::App* subcommand : app.get_subcommands()) {
      reject_arguments_before(*subcommand, app);
    }
    if (describing->parsed()) {
      return printed(with_place("describe: ", [&] { return describe(describe_texts); }));
    }
    Parsed parsed;
    if (playing->parsed()) {
      parsed.task = task_of(play_texts);
    } else {
      parsed.setup = setup_of(texts);
    }
    return parsed;
  } catch (const std::invalid_argument& error) {
    return wrong(error.what());
  }
}

}  // namespace ex9000::sim
