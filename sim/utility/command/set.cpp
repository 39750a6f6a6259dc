#include "sim/utility/command/set.hpp"

#include <yaml-cpp/yaml.h>

#include <fstream>
#include <map>

#include "sim/text/system_error.hpp"
#include "sim/text/values.hpp"
#include "sim/utility/command/opened.hpp"
#include "sim/utility/device/property.hpp"

namespace ex9000::utility {

namespace {

using Values = std::map<std::string, std::string>;

Values values_of(const sim::Words& words) {
  Values values;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) {
      sim::fail("'" + word + "': expected KEY=VALUE");
    }
    const std::string key(property_called(word.substr(0, equals)).key);
    if (!values.emplace(key, word.substr(equals + 1)).second) {
      sim::fail("'" + key + "' is there twice; name each setting once");
    }
  }
  return values;
}

/// Of all settings that the module has in its protocol.
Values read_all(Opened& opened) {
  Values values;
  for (const Property& property : properties) {
    try {
      if (meets(*opened.model, property.needs)) {
        values[std::string(property.key)] = property.read(opened.device, *opened.model);
      }
    } catch (const Absent&) {
    }
  }
  return values;
}

/// As the module writes them. Throws before anything changes.
Values formed(const Values& values, const Model& model) {
  Values result;
  for (const auto& [key, value] : values) {
    const Property& property = property_called(key);
    if (!meets(model, property.needs)) {
      sim::fail(key + ": an " + std::string(model.designation) + " does not have this setting");
    }
    result[key] = sim::with_place(key + ": ", [&, &text = value] { return property.form(model, text); });
  }
  return result;
}

/// In the order of the table. Says what changes, after `lead`; reads back.
void apply(Environment& environment, Opened& opened, const Values& given, bool dry_run,
           const std::string& lead = "") {
  const Values wanted = formed(given, *opened.model);
  bool reset_needed = false;
  bool changed = false;
  for (const Property& property : properties) {
    const auto value = wanted.find(std::string(property.key));
    if (value == wanted.end()) {
      continue;
    }
    sim::with_place(value->first + ": ", [&] {
      const std::string before = property.read(opened.device, *opened.model);
      if (before == value->second) {
        return;
      }
      const bool at_reset = needs_reset(property, opened.device);
      environment.output << lead << value->first << ": " << before << " -> " << value->second
                         << (at_reset ? ", in force from the next reset on" : "")
                         << (property.beware.empty() ? "" : "; " + std::string(property.beware)) << std::endl;
      changed = true;
      reset_needed = reset_needed || at_reset;
      if (!dry_run) {
        property.write(opened.device, *opened.model, value->second);
        const std::string after = property.read(opened.device, *opened.model);
        if (after != value->second) {
          throw Failed("it reads " + after + " after the change");
        }
      }
    });
  }
  environment.output << (changed && !dry_run && !reset_needed ? "" : lead)
                     << (!changed       ? "nothing to change\n"
                         : dry_run      ? "nothing has been changed (--dry-run)\n"
                         : reset_needed ? "switch the module off and on\n"
                                        : "")
                     << std::flush;
}

// --- files ---

[[noreturn]] void refuse_other_model(const std::string& saved, const Model& model) {
  std::string text = "the settings are those of an " + saved + ", and the module is an ";
  text += model.designation;
  sim::fail(text + "; their channels and commands differ");
}

/// The settings for the module: the only entry, or that with this serial number or address.
Values entry_in(const YAML::Node& file, const std::string& module, const Model& model) {
  if (!file.IsSequence() || file.size() == 0) {
    sim::fail("expected a list of modules, as 'ex9000 save' writes it");
  }
  for (const YAML::Node& entry : file) {
    const bool named = entry["serial-number"].as<std::string>("") == module ||
                       entry["settings"]["address"].as<std::string>("") == module;
    if (file.size() != 1 && !named) {
      continue;
    }
    const auto saved = entry["model"].as<std::string>("");
    if (saved != model.designation) {
      refuse_other_model(saved, model);
    }
    Values values;
    for (const auto& setting : entry["settings"]) {
      values.emplace(property_called(setting.first.as<std::string>()).key, setting.second.as<std::string>());
    }
    return values;
  }
  sim::fail("has " + std::to_string(file.size()) + " modules, but none with the address or serial number " +
            module + "; name it with --entry");
}

Values entry_for(const std::string& path, const std::string& module, const Model& model) {
  return sim::with_place(path + ": ", [&] {
    std::ifstream file(path);
    if (!file) {
      sim::unavailable(sim::reason() + "; name a file that you can read");
    }
    try {
      return entry_in(YAML::Load(file), module, model);
    } catch (const YAML::Exception& error) {
      sim::fail("line " + std::to_string(error.mark.line + 1) + ": " + error.msg);
    }
  });
}

}  // namespace

bool set(Environment& environment, const sim::Words& args, const Options& options) {
  const Values wanted = values_of({args.begin() + 2, args.end()});
  const sim::Words modules = expand_modules({args[1]});
  for (const std::string& module : modules) {
    Opened opened(environment, args[0], module, options);
    apply(environment, opened, wanted, options.dry_run, modules.size() == 1 ? "" : module + ": ");
  }
  return true;
}

bool set_address_by_number(Environment& environment, const sim::Words& args, const Options& options) {
  constexpr unsigned kOwnAddress = 0x0080;  // in force after the reply
  const Addressee to = parse_addressee(args[1]);
  if (to.by_address()) {
    sim::fail("'" + args[1] + "': expected a serial number of 8 hex digits; 'ex9000 scan' shows it");
  }
  const Addressee other = parse_addressee(args[2]);
  if (!other.by_address()) {
    sim::fail("'" + args[2] + "': expected an address from 1 to 247");
  }
  MasterLine line(environment, parse_port(args[0]), options.line);
  Device device = Device::in_modbus(line, to);
  const unsigned before = device.read(read_words(kOwnAddress, 1)).word(0);
  Device at_new = Device::in_modbus(line, other);
  if (before != other.request[0] &&
      at_new.module().try_once(read_words(kOwnAddress, 1), std::chrono::milliseconds(300))) {
    sim::fail(args[2] + ": another module has this address; choose one that 'ex9000 scan' does not show");
  }
  device.write(write_word(kOwnAddress, other.request[0]));
  environment.output << args[1] << ": address " << before << " -> " << args[2] << ", in force now"
                     << std::endl;
  return true;
}

bool save(Environment& environment, const sim::Words& args, const Options& options) {
  YAML::Emitter out;
  out << YAML::BeginSeq;
  for (const std::string& module : expand_modules({args[1]})) {
    Opened opened(environment, args[0], module, options);
    out << YAML::BeginMap << YAML::Key << "model" << YAML::Value << std::string(opened.model->designation);
    if (opened.identity.serial_number) {
      out << YAML::Key << "serial-number" << YAML::Value
          << sim::hex_long_text(*opened.identity.serial_number);
    }
    out << YAML::Key << "settings" << YAML::Value << YAML::BeginMap;
    const Values values = read_all(opened);
    for (const Property& property : properties) {
      const auto value = values.find(std::string(property.key));
      if (value != values.end()) {
        out << YAML::Key << value->first << YAML::Value << YAML::DoubleQuoted << value->second;
      }
    }
    out << YAML::EndMap << YAML::EndMap;
    environment.output << opened.device.name() << ": " << opened.model->designation << ", " << values.size()
                       << " settings" << std::endl;
  }
  out << YAML::EndSeq;
  std::ofstream file(args.back());
  file << out.c_str() << "\n";
  if (!file.flush()) {
    sim::unavailable(args.back() + ": " + sim::reason() + "; name a file that you can write");
  }
  return true;
}

bool restore(Environment& environment, const sim::Words& args, const Options& options) {
  Opened opened(environment, args[0], args[1], options);
  const Values wanted = entry_for(args[2], options.entry.empty() ? args[1] : options.entry, *opened.model);
  apply(environment, opened, wanted, options.dry_run);
  return true;
}

}  // namespace ex9000::utility
