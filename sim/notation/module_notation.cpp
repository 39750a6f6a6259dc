#include "sim/notation/module_notation.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <numeric>
#include <string_view>
#include <utility>

#include "sim/notation/module_settings.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

/// In upper case, with EX.
std::string full_name(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return name.rfind("EX", 0) == 0 ? name : "EX" + name;
}

std::string digits_of(std::string_view text) {
  std::string digits;
  std::copy_if(text.begin(), text.end(), std::back_inserter(digits),
               [](char c) { return c >= '0' && c <= '9'; });
  return digits;
}

/// How many characters to insert, delete or replace.
std::size_t edits_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j + 1] + 1, row[j] + 1});
    }
  }
  return row.back();
}

/// Those with the number in `name`, else those that differ least from `name`, by at most two characters.
Words nearest_models(const std::string& name) {
  constexpr std::size_t kFarthest = 2;
  constexpr std::size_t kLongest = 16;
  const std::string number = digits_of(name);
  Words same_number;
  Words nearest;
  std::size_t least = kFarthest;
  for (const Model& model : kModels) {
    if (digits_of(model.designation) == number) {
      same_number.emplace_back(model.designation);
    }
    const std::size_t edits =
        name.size() > kLongest ? kFarthest + 1 : edits_between(full_name(name), model.designation);
    if (edits < least) {
      nearest.clear();
      least = edits;
    }
    if (edits == least) {
      nearest.emplace_back(model.designation);
    }
  }
  return same_number.empty() ? nearest : same_number;
}

}  // namespace

void refuse_model(const std::string& name) {
  const Words nearest = nearest_models(name);
  fail("'" + name + "' is not a model; " +
       (nearest.empty() ? "" : "nearest: " + joined(nearest, ", ") + "; ") +
       "'ex9000-sim --models' lists all models");
}

const Model& model_called(const std::string& name) {
  if (const Model* model = find_model(full_name(name))) {
    return *model;
  }
  refuse_model(name);
}

ModuleSpec factory_fresh(const Model& model) {
  ModuleSpec spec;
  spec.model = &model;
  spec.settings = Settings::factory(model);
  return spec;
}

void take_module_setting(ModuleSpec& spec, const std::string& name, const std::string& place,
                         const std::string& value) {
  for (const Setting<ModuleSpec>& setting : module_settings) {
    if (setting.name == name) {
      with_place(place, [&] {
        if (setting.form != Form::List && spec.places.count(name) != 0) {
          fail("is given twice; leave out one of them");
        }
      });
      take_setting(setting, spec, place, value);
      return;
    }
  }
  fail(place + "unknown key; expected one of " + names_of(module_settings));
}

void check(const ModuleSpec& spec) {
  if (spec.settings.protocol == Protocol::ModbusRtu && !is_modbus_address(spec.settings.address)) {
    fail("address " + hex_byte_text(spec.settings.address) +
         ": is not a Modbus address; expected hex 01 to F7, or the protocol ascii");
  }
}

ModuleSpec parse_module_spec(const std::string& text) {
  return with_place((text.empty() ? "an empty argument" : text) + ": ", [&] {
    const Words parts = parts_of(text, ',');
    const std::string& name = parts[0];
    const auto at = name.find('@');
    ModuleSpec spec = factory_fresh(model_called(name.substr(0, at)));
    if (at != std::string::npos) {
      take_module_setting(spec, "address", "address: ", name.substr(at + 1));
    }
    for (auto option = parts.begin() + 1; option != parts.end(); ++option) {
      if (option->empty()) {
        fail("nothing follows a comma; leave the comma out, or add KEY=VALUE");
      }
      const auto equals = option->find('=');
      const std::string key = option->substr(0, equals);
      take_module_setting(spec, key,
                          key + "=: ", equals == std::string::npos ? "" : option->substr(equals + 1));
    }
    check(spec);
    prefix_places(spec.places, text + ": ");
    return spec;
  });
}

}  // namespace ex9000::sim
