// The options of the command line that are settings.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/notation/setting.hpp"

namespace ex9000::sim {

/// By the name of their option, as the user has given them.
class Options {
 public:
  template <class Settings>
  void add(CLI::App& app, const Settings& settings) {
    for (const auto& setting : settings) {
      add(app, setting);
    }
  }
  template <class Object>
  void add(CLI::App& app, const Setting<Object>& setting) {
    app.add_option("--" + std::string(setting.name), values_[setting.name], std::string(setting.does))
        ->expected(1)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->type_name(shape_of(setting.form, setting.value));
  }

  [[nodiscard]] bool has(std::string_view name) const {
    const auto values = values_.find(name);
    return values != values_.end() && !values->second.empty();
  }

  /// In the order of `settings`. The last Form::Optional counts, so that a script's caller can override it.
  template <class Settings, class Object>
  void apply(const Settings& settings, Object& object) const {
    for (const auto& setting : settings) {
      if (!has(setting.name)) {
        continue;
      }
      const std::string place = "--" + std::string(setting.name) + ": ";
      const std::vector<std::string>& values = values_.find(setting.name)->second;
      if (setting.form == Form::List) {
        for (const std::string& value : values) {
          take_setting(setting, object, place, value);
        }
      } else if (values.size() > 1 && setting.form != Form::Optional) {
        fail(place + "is given twice; leave out one of them");
      } else {
        take_setting(setting, object, place, values.back());
      }
    }
  }

 private:
  static std::string shape_of(Form form, std::string_view value);

  std::map<std::string_view, std::vector<std::string>> values_;
};

/// The arguments, with `=on` after an option that may stand without a value unless it accepts the next word:
/// CLI11 would take any. Throws if an option without its value is before another option.
std::vector<std::string> complete_words(const CLI::App& app, int argc, const char* const* argv);

}  // namespace ex9000::sim
