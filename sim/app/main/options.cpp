#include "sim/app/main/options.hpp"

#include <stdexcept>

#include "sim/app/setup/setup.hpp"

namespace ex9000::sim {

namespace {

/// true: the option may stand without a value. `takes_next`: it accepts `next` as its value.
template <class Settings, class Object>
bool stands_alone(const Settings& settings, const std::string& word, const std::string& next, Object scratch,
                  bool& takes_next) {
  for (const auto& setting : settings) {
    if (word != "--" + std::string(setting.name)) {
      continue;
    }
    if (setting.form == Form::Optional) {
      try {
        setting.take(scratch, next);
        takes_next = true;
      } catch (const std::invalid_argument&) {
        takes_next = false;
      }
    }
    return setting.form == Form::Optional || setting.form == Form::Flag;
  }
  return false;
}

[[noreturn]] void value_missing(const CLI::Option& option, const std::string& word, const std::string& next) {
  fail(word + ": the value is missing before " + next + "; expected " + word + " " + option.get_type_name());
}

}  // namespace

std::string Options::shape_of(Form form, std::string_view value) {
  return form == Form::Flag       ? ""
         : form == Form::Optional ? "[" + std::string(value) + "]"
                                  : std::string(value);
}

std::vector<std::string> complete_words(const CLI::App& app, int argc, const char* const* argv) {
  std::vector<const CLI::App*> apps =
      app.get_subcommands([](const CLI::App* /*subcommand*/) { return true; });
  apps.insert(apps.begin(), &app);
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    words.emplace_back(argv[i]);
    const std::string word = argv[i];
    const std::string next = i + 1 < argc ? argv[i + 1] : "";
    bool takes_next = false;
    if (stands_alone(run_settings, word, next, Setup(), takes_next) ||
        stands_alone(line_settings, word, next, LineSetup(), takes_next)) {
      words.back() += "=" + (takes_next ? next : "on");
      i += takes_next ? 1 : 0;
      continue;
    }
    for (const CLI::App* each : apps) {
      const CLI::Option* option = word.rfind("--", 0) == 0 ? each->get_option_no_throw(word) : nullptr;
      if (option != nullptr && option->get_items_expected_min() > 0 && next.rfind("--", 0) == 0) {
        value_missing(*option, word, next.substr(0, next.find('=')));
      }
    }
  }
  return words;
}

}  // namespace ex9000::sim
