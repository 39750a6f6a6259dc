#include "sim/utility/command/program.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <list>
#include <map>
#include <string>

#include "firmware/model/model.hpp"
#include "sim/notation/shape.hpp"
#include "sim/text/error_line.hpp"
#include "sim/utility/command/help.hpp"

namespace ex9000::utility {

namespace {

constexpr int kProblem = 1;
constexpr int kInterrupted = 130;

using Given = std::map<std::string_view, std::vector<std::string>>;

/// The words of one verb on the command line.
struct Texts {
  const Verb* verb;
  sim::Words args = {};
  Given given = {};
  std::map<std::string_view, bool> flags = {};

  [[nodiscard]] bool flag(std::string_view name) const {
    const auto found = flags.find(name);
    return found != flags.end() && found->second;
  }
};

void add(CLI::App& app, Texts& texts) {
  const Verb& verb = *texts.verb;
  CLI::App* const command = app.add_subcommand(std::string(verb.name()));
  command->add_option("ARGUMENTS", texts.args);
  for (const sim::Setting<Options>& option : known_options) {
    const std::string name = "--" + std::string(option.name);
    if (verb.takes(option.name) && option.form == sim::Form::Flag) {
      command->add_flag(name, texts.flags[option.name]);
    } else if (verb.takes(option.name)) {
      command->add_option(name, texts.given[option.name])->expected(1)->allow_extra_args(false);
    }
  }
}

Options options_of(const Texts& texts) {
  Options taken;
  for (const sim::Setting<Options>& option : known_options) {
    const auto given = texts.given.find(option.name);
    const auto flag = texts.flags.find(option.name);
    if (given != texts.given.end() && !given->second.empty()) {
      sim::take_setting(option, taken, "--" + std::string(option.name) + ": ", given->second.back());
    }
    if (flag != texts.flags.end() && flag->second) {
      sim::take_setting(option, taken, "--" + std::string(option.name) + ": ", "on");
    }
  }
  return taken;
}

int run(const Texts& texts, Environment& environment) {
  sim::check_shape(texts.verb->shape, texts.args, "expected ex9000 ");
  if (texts.flag("ascii") && texts.flag("modbus")) {
    sim::fail("--ascii: excludes --modbus; leave out one of them");
  }
  const bool good = texts.verb->run(environment, texts.args, options_of(texts));
  environment.check_output();
  return good ? 0 : kProblem;
}

}  // namespace

int run_program(int argc, const char* const* argv, Environment& environment) {
  const auto report = [&](const std::string& problem, int status) {
    environment.error << "ex9000: " << sim::one_line(problem) << std::endl;
    return status;
  };
  CLI::App app("", "ex9000");
  app.set_version_flag("--version", "ex9000 " + std::string(kFirmwareVersion));
  app.require_subcommand(1, 1);
  std::list<Texts> all;
  for (const Verb& verb : verbs) {
    add(app, all.emplace_back(Texts{&verb}));
  }
  const auto chosen = [&]() -> const Texts* {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Texts& texts) {
      return app.got_subcommand(std::string(texts.verb->name()));
    });
    return found == all.end() ? nullptr : &*found;
  };
  try {
    app.parse(argc, argv);
    return run(*chosen(), environment);
  } catch (const CLI::CallForHelp&) {
    environment.output << (chosen() == nullptr ? program_help() : help_of(*chosen()->verb)) << std::flush;
    return environment.output ? 0 : kProblem;
  } catch (const CLI::CallForVersion& version) {
    environment.output << version.what() << std::endl;
    return 0;
  } catch (const CLI::ParseError& error) {
    return report(std::string(error.what()) + "; see --help", sim::kWrongArguments);
  } catch (const Interrupted&) {
    return kInterrupted;
  } catch (const std::invalid_argument& error) {
    return report(error.what(), sim::kWrongArguments);
  } catch (const std::exception& error) {
    return report(error.what(), kProblem);
  }
}

}  // namespace ex9000::utility
