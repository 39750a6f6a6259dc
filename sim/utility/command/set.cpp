#include "sim/utility/command/set.hpp"

#include <yaml-cpp/yaml.h>

#include <cstdio>
#include <fstream>

#include "sim/text/system_error.hpp"
#include "sim/text/values.hpp"
#include "sim/utility/command/change.hpp"
#include "sim/utility/device/channels.hpp"
#include "sim/utility/device/property.hpp"
#include "sim/utility/modbus/register_map.hpp"

namespace ex9000::utility {

namespace {

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

// --- files ---

[[noreturn]] void refuse_other_model(const std::string& saved, const Model& model) {
  std::string text = "the settings are those of an " + saved + ", and the module is an ";
  text += model.designation;
  sim::fail(text + "; their channels and commands differ");
}

/// The EX9068D-M and the EX9068AD-M are one for a master.
bool are_equal(const Model* saved, const Model& model) {
  return saved == &model ||
         (saved != nullptr && saved->modbus_code != 0 && saved->modbus_code == model.modbus_code);
}

/// The settings for the module: that with this serial number or address, or the only entry.
Values entry_in(const YAML::Node& file, const std::string& module, bool must_be_named, const Model& model) {
  if (!file.IsSequence() || file.size() == 0) {
    sim::fail("expected a list of modules, as 'ex9000 save' writes it");
  }
  for (const YAML::Node& entry : file) {
    if (!entry.IsMap() || !entry["settings"].IsDefined() || !entry["settings"].IsMap()) {
      sim::fail("line " + std::to_string(entry.Mark().line + 1) +
                ": expected a module with model and settings");
    }
    const bool named = entry["serial-number"].as<std::string>("") == module ||
                       entry["settings"]["address"].as<std::string>("") == module;
    if (!named && (file.size() != 1 || must_be_named)) {
      continue;
    }
    const auto saved = entry["model"].as<std::string>("");
    if (!are_equal(find_model(saved), model)) {
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

Values entry_for(const std::string& path, const std::string& module, bool must_be_named, const Model& model) {
  return sim::with_place(path + ": ", [&] {
    std::ifstream file(path);
    if (!file) {
      sim::unavailable(sim::reason() + "; name a file that you can read");
    }
    try {
      return entry_in(YAML::Load(file), module, must_be_named, model);
    } catch (const YAML::Exception& error) {
      sim::fail("line " + std::to_string(error.mark.line + 1) + ": " + error.msg);
    }
  });
}

/// Beside the old one first, so that a full disk leaves that as it is.
void write_file(const std::string& path, const std::string& text) {
  const std::string fresh = path + ".new";
  std::ofstream file(fresh);
  file << text << "\n";
  if (!file.flush() || std::rename(fresh.c_str(), path.c_str()) != 0) {
    const std::string reason = sim::reason();
    static_cast<void>(std::remove(fresh.c_str()));
    sim::unavailable(path + ": " + reason + "; name a file that you can write");
  }
}

}  // namespace

bool set(Environment& environment, const sim::Words& args, const Options& options) {
  const Values wanted = values_of({args.begin() + 2, args.end()});
  const sim::Words modules = expand_modules({args[1]});
  if (modules.size() > 1 && wanted.count("address") != 0) {
    sim::fail("address: several modules cannot have the same; name one module");
  }
  MasterLine line(environment, parse_port(args[0]), options.line);
  for (const std::string& module : modules) {
    const std::string lead = modules.size() == 1 ? "" : module + ": ";
    sim::with_place(lead, [&] {
      Opened opened(environment, line, module, options);
      change(environment, opened, wanted, {options.dry_run, lead});
    });
  }
  return true;
}

bool set_address_by_number(Environment& environment, const sim::Words& args, const Options& options) {
  constexpr unsigned kOwnAddress = registers_of("own-address");  // in force after the reply
  const Addressee to = parse_addressee(args[1]);
  if (to.by_address()) {
    sim::fail("'" + args[1] + "': expected a serial number of 8 hex digits; 'ex9000 scan' shows it");
  }
  const std::uint8_t wanted = parse_address(args[2]);
  if (!is_modbus_address(wanted)) {
    sim::fail("'" + args[2] + "': expected an address from 1 to 247");
  }
  MasterLine line(environment, parse_port(args[0]), options.line);
  Device device = Device::in_modbus(line, to);
  const unsigned before = device.read(read_words(kOwnAddress, 1)).word(0);
  if (before != wanted && !is_free(line, wanted)) {
    sim::fail(args[2] + ": another module has this address; choose one that 'ex9000 scan' does not show");
  }
  device.write(write_word(kOwnAddress, wanted));
  environment.output << to.name << ": address " << before << " -> " << unsigned{wanted} << ", in force now"
                     << std::endl;
  return true;
}

bool save(Environment& environment, const sim::Words& args, const Options& options) {
  const sim::Words modules = expand_modules({args[1]});
  MasterLine line(environment, parse_port(args[0]), options.line);
  YAML::Emitter out;
  out << YAML::BeginSeq;
  bool complete = true;
  bool any = false;
  for (const std::string& module : modules) {
    try {
      Opened opened(environment, line, module, options);
      const Values values = read_all(opened);
      if (has_timed_out(opened.device)) {
        environment.error << module
                          << ": its host watchdog has timed out, which switched it off: the file says off"
                          << std::endl;
      }
      out << YAML::BeginMap << YAML::Key << "model" << YAML::Value << std::string(opened.model->designation);
      if (opened.identity.serial_number) {
        out << YAML::Key << "serial-number" << YAML::Value
            << sim::hex_long_text(*opened.identity.serial_number);
      }
      out << YAML::Key << "settings" << YAML::Value << YAML::BeginMap;
      for (const Property& property : properties) {
        const auto value = values.find(std::string(property.key));
        if (value != values.end()) {
          out << YAML::Key << value->first << YAML::Value << YAML::DoubleQuoted << value->second;
        }
      }
      out << YAML::EndMap << YAML::EndMap;
      environment.output << module << ": " << opened.model->designation << ", " << values.size()
                         << " settings" << std::endl;
      any = true;
    } catch (const Failed& error) {
      environment.error << module << ": not saved: " << error.what() << std::endl;
      complete = false;
    } catch (const std::invalid_argument& error) {  // its model is unknown, or it is not the one of --model
      environment.error << module << ": not saved: " << error.what() << std::endl;
      complete = false;
    }
  }
  out << YAML::EndSeq;
  if (!any) {
    throw Failed(args[2] + ": not written, because no module could be read");
  }
  write_file(args[2], out.c_str());
  return complete;
}

bool restore(Environment& environment, const sim::Words& args, const Options& options) {
  MasterLine line(environment, parse_port(args[0]), options.line);
  Opened opened(environment, line, args[1], options);
  const std::string entry = expand_modules({options.entry.empty() ? args[1] : options.entry})[0];
  const Values wanted = entry_for(args[2], entry, !options.entry.empty(), *opened.model);
  return change(environment, opened, wanted, {options.dry_run, "", true});
}

}  // namespace ex9000::utility
