#include "sim/utility/command/change.hpp"

#include <algorithm>
#include <vector>

#include "sim/text/fail.hpp"
#include "sim/text/words.hpp"
#include "sim/utility/device/property.hpp"

namespace ex9000::utility {

namespace {

struct Change {
  const Property* property;
  std::string before;
  std::string after;

  [[nodiscard]] std::string key() const { return std::string(property->key); }
};

struct Plan {
  std::vector<Change> changes;
  sim::Words later;  ///< keys
};

/// As the module writes them.
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

Plan plan_for(Opened& opened, const Values& wanted, bool in_part) {
  Plan plan;
  for (const Property& property : properties) {
    const auto value = wanted.find(std::string(property.key));
    if (value == wanted.end()) {
      continue;
    }
    try {
      std::string before = property.read(opened.device, *opened.model);
      if (before == value->second) {
        continue;
      }
      if (property.only_in_ascii && opened.device.speaks_modbus()) {
        throw Absent(
            "takes this only in ASCII; tie INIT* to GND, reset it, and use the address 0 at 9600 baud");
      }
      plan.changes.push_back({&property, std::move(before), value->second});
    } catch (const Absent& error) {
      if (!in_part) {
        throw Failed(value->first + ": " + error.what());
      }
      plan.later.push_back(value->first);
    }
  }
  return plan;
}

bool will_speak_modbus(Opened& opened, const Plan& plan) {
  for (const Change& change : plan.changes) {
    if (change.property->key == "protocol") {
      return change.after == "modbus";
    }
  }
  const Property& protocol = property_called("protocol");
  return meets(*opened.model, protocol.needs) && protocol.read(opened.device, *opened.model) == "modbus";
}

void check_address(Opened& opened, const Plan& plan) {
  for (const Change& change : plan.changes) {
    if (change.property->key != "address") {
      continue;
    }
    const std::uint8_t address = parse_address(change.after);
    if (will_speak_modbus(opened, plan) && !is_modbus_address(address)) {
      sim::fail("address: '" + change.after + "': expected 1 to 247, because the module speaks Modbus");
    }
    if (!is_free(opened.line(), address)) {
      sim::fail("address: another module has the address " + change.after + "; choose a free one");
    }
  }
}

void print(Environment& environment, const Opened& opened, const Plan& plan, const std::string& lead) {
  for (const Change& change : plan.changes) {
    environment.output << lead << change.key() << ": " << change.before << " -> " << change.after
                       << (needs_reset(*change.property, opened.device) ? ", in force from the next reset on"
                                                                        : "")
                       << (change.property->beware.empty() ? "" : "; " + std::string(change.property->beware))
                       << std::endl;
  }
}

std::string keys_of(const std::vector<Change>& changes, std::size_t first, std::size_t last) {
  sim::Words keys;
  for (std::size_t i = first; i < last; ++i) {
    keys.push_back(changes[i].key());
  }
  return keys.empty() ? "nothing" : sim::joined(keys, ", ");
}

/// `at`: which one was under way. Nothing, if it is the only one.
std::string outcome(const Plan& plan, std::size_t at) {
  return plan.changes.size() == 1
             ? ""
             : " (changed: " + keys_of(plan.changes, 0, at) + "; perhaps: " + plan.changes[at].key() +
                   "; not: " + keys_of(plan.changes, at + 1, plan.changes.size()) + ")";
}

void carry_out(Environment& environment, Opened& opened, const Plan& plan) {
  std::size_t at = 0;
  try {
    for (; at < plan.changes.size(); ++at) {
      plan.changes[at].property->write(opened.device, *opened.model, plan.changes[at].after);
    }
  } catch (const Interrupted&) {
    environment.error << "ex9000: stopped" << outcome(plan, at) << std::endl;
    throw;
  } catch (const std::exception& error) {
    throw Failed(plan.changes[at].key() + ": " + error.what() + outcome(plan, at));
  }
  for (const Change& change : plan.changes) {
    const std::string now = change.property->read(opened.device, *opened.model);
    if (now != change.after) {
      throw Failed(change.key() + ": reads " + now + " after the change");
    }
  }
}

}  // namespace

Values read_all(Opened& opened) {
  Values values;
  for (const Property& property : properties) {
    try {
      if (meets(*opened.model, property.needs)) {
        values[std::string(property.key)] = property.read(opened.device, *opened.model);
      }
    } catch (const Absent&) {  // NOLINT(bugprone-empty-catch)
      // the module does not have it
    }
  }
  return values;
}

bool change(Environment& environment, Opened& opened, const Values& values, const ChangeOptions& options) {
  const Plan plan = plan_for(opened, formed(values, *opened.model), options.in_part);
  check_address(opened, plan);
  print(environment, opened, plan, options.lead);
  const bool reset_needed = std::any_of(plan.changes.begin(), plan.changes.end(), [&](const Change& each) {
    return needs_reset(*each.property, opened.device);
  });
  if (!options.dry_run) {
    carry_out(environment, opened, plan);
  }
  const char* const end = plan.changes.empty()      ? (plan.later.empty() ? "nothing to change" : "")
                          : options.dry_run         ? "nothing has been changed (--dry-run)"
                          : !reset_needed           ? ""
                          : opened.device.in_init() ? "release INIT*, and switch the module off and on"
                                                    : "switch the module off and on";
  if (*end != '\0') {
    environment.output << options.lead << end << std::endl;
  }
  if (!plan.later.empty()) {
    environment.error << options.lead << "left out, because the module takes it only in ASCII: "
                      << sim::joined(plan.later, ", ") << "; reset it and repeat the command" << std::endl;
  }
  return plan.later.empty();
}

}  // namespace ex9000::utility
