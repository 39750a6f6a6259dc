#include "sim/app/main/arguments.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "sim/app/exports/describe.hpp"
#include "sim/app/main/help.hpp"
#include "sim/app/main/options.hpp"
#include "sim/app/setup/bus_file.hpp"
#include "sim/app/setup/schema.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

constexpr const char* kDescription = "Simulated EX9000 modules on RS-485 lines, for Modbus and DCON masters.";

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

std::string version_line() { return "ex9000-sim " + std::string(kFirmwareVersion) + "\n"; }

Parsed wrong(const std::string& what) {
  Parsed parsed;
  parsed.error = "ex9000-sim: " + one_line(what) + "\n";
  parsed.exit_status = kWrongArguments;
  return parsed;
}

/// Those that `play` has too.
bool is_for_play(const Setting<Setup>& setting) {
  return setting.name == "log" || setting.name == "capture" || setting.name == "seed";
}

LineSetup line_of(const std::vector<std::string>& modules, const Options& options) {
  LineSetup line;
  for (const std::string& module : modules) {
    line.modules.push_back(parse_module_spec(module));
  }
  options.apply(line_settings, line);
  return line;
}

/// A bus file has everything about its lines.
void reject_beside(const std::string& bus_file, const std::vector<std::string>& modules,
                   const Options& options) {
  for (const Setting<LineSetup>& setting : line_settings) {
    if (options.has(setting.name)) {
      fail("--" + std::string(setting.name) + ": cannot be combined with a bus file; add it to the bus file");
    }
  }
  if (modules.size() != 1) {
    fail(bus_file + ": a bus file has all modules; leave out the other arguments");
  }
}

/// Reads the bus file if the arguments name one. An option overrides the key with the same name.
Setup setup_of(const std::vector<std::string>& modules, const Options& options) {
  if (modules.empty()) {
    fail("no module given; try 'ex9000-sim EX9042D-M' or --help");
  }
  Setup setup;
  const auto bus_file = std::find_if(modules.begin(), modules.end(), is_bus_file);
  if (bus_file != modules.end()) {
    reject_beside(*bus_file, modules, options);
    setup = read_bus_file(*bus_file);
  } else {
    setup.lines.push_back(line_of(modules, options));
  }
  options.apply(run_settings, setup);
  complete(setup);
  return setup;
}

struct PlayTexts {
  std::string file;
  std::vector<std::string> modules;
  Options options;
};

CLI::App* add_play(CLI::App& app, PlayTexts& texts) {
  CLI::App* const play = app.add_subcommand("play", "play transcripts or scenarios in virtual time");
  play->footer(help::of_play());
  play->add_option("FILE", texts.file, "the file, or a folder of such files")->required();
  play->add_option("MODULE", texts.modules, "for a scenario: the modules, or a bus file");
  for (const Setting<Setup>& setting : run_settings) {
    if (is_for_play(setting)) {
      texts.options.add(*play, setting);
    }
  }
  return play;
}

play::Task task_of(const PlayTexts& texts) {
  play::Task task;
  task.path = texts.file;
  Setup writing;
  texts.options.apply(run_settings, writing);
  task.writing = static_cast<const Writing&>(writing);
  if (!texts.modules.empty()) {
    task.bus = setup_of(texts.modules, texts.options);
  }
  return task;
}

CLI::App* add_describe(CLI::App& app, DescribeTexts& texts) {
  CLI::App* const describe = app.add_subcommand(
      "describe", "print the commands and registers of one model or of all models, and exit");
  describe->footer(
      "\nFormats. Those with MODEL require a model that speaks Modbus; the others describe one model or all "
      "models:\n" +
      format_help());
  describe->add_option("MODEL", texts.model,
                       "a name from --models, in upper or lower case, with or without EX");
  describe->add_option("--format", texts.format, "set the format (default: markdown)")
      ->type_name(format_names());
  describe
      ->add_option("--address", texts.address,
                   "name the module's Modbus address in hex, for formats that need it (default: 01)")
      ->type_name("HH");
  describe
      ->add_option("--port", texts.port,
                   "name the port of the simulator: tcp:HOST:PORT or modbus-tcp:HOST:PORT (default: "
                   "tcp:127.0.0.1:5020)")
      ->type_name("PORT");
  return describe;
}

Parsed printed(const std::string& text) {
  Parsed parsed;
  parsed.output = text;
  return parsed;
}

/// Those for `app` itself, not for a subcommand, in the order in which they were added to `app`.
std::vector<const CLI::Option*> given_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->count() != 0; });
}

/// Of a positional argument, its first value, as the user wrote it.
std::string name_of(const CLI::Option& option) {
  return option.get_positional() ? option.results().front() : option.get_name();
}

/// They would have no effect there.
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

/// `printing`: an option that prints text and runs nothing.
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

Parsed parse_arguments(int argc, const char* const* argv) {
  CLI::App app(kDescription, "ex9000-sim");
  app.set_help_flag("-h,--help", "print this help");
  std::vector<std::string> modules;
  Options options;
  app.add_option("MODULE", modules, "the modules on the line, or a bus file; see 'help modules'")
      ->type_name("");
  options.add(app, line_settings);
  options.add(app, run_settings);
  bool models = false;
  bool example = false;
  bool schema = false;
  bool version = false;
  app.add_flag("--models", models, "list the models");
  app.add_flag("--example", example, "print an example of a bus file");
  app.add_flag("--schema", schema, "print the JSON Schema of bus files");
  app.add_flag("--version", version, "print the version");
  app.require_subcommand(0, 1);  // with the limit 1, `play describe` plays the file `describe`
  PlayTexts play_texts;
  const CLI::App* const playing = add_play(app, play_texts);
  DescribeTexts describe_texts;
  const CLI::App* const describing = add_describe(app, describe_texts);
  std::string topic;
  CLI::App* const helping = app.add_subcommand("help", "explain a notation: " + help::topics());
  helping->add_option("TOPIC", topic, help::topics());
  app.footer(help::examples);  // after the subcommands, which would inherit it
  app.get_formatter()->column_width(help::kColumn);
  try {
    std::vector<std::string> words = complete_words(app, argc, argv);
    std::reverse(words.begin(), words.end());  // CLI11 expects the last word first
    app.parse(words);
  } catch (const CLI::CallForHelp&) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    return printed(chosen.empty() ? app.help() : chosen.front()->help("ex9000-sim"));
  } catch (const CLI::ParseError& error) {
    return wrong(std::string(error.what()) + "; see --help");
  } catch (const std::invalid_argument& error) {
    return wrong(error.what());
  }
  try {
    for (const auto& [flag, is_given, text] :
         {std::tuple("--models", models, &list_models), std::tuple("--example", example, &example_bus_file),
          std::tuple("--schema", schema, &bus_file_schema),
          std::tuple("--version", version, &version_line)}) {
      if (is_given) {
        reject_other_arguments(flag, app);
        return printed(text());
      }
    }
    for (const CLI::App* subcommand : app.get_subcommands()) {
      reject_arguments_before(*subcommand, app);
    }
    if (helping->parsed()) {
      return printed(help::on(topic));
    }
    if (describing->parsed()) {
      return printed(with_place("describe: ", [&] { return describe(describe_texts); }));
    }
    Parsed parsed;
    if (playing->parsed()) {
      parsed.task = task_of(play_texts);
    } else {
      parsed.setup = setup_of(modules, options);
    }
    return parsed;
  } catch (const std::invalid_argument& error) {
    return wrong(error.what());
  }
}

}  // namespace ex9000::sim
