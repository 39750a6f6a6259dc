#include "sim/line_monitor/module_view/face.hpp"

#include <chrono>
#include <tuple>

#include "hal/eeprom/two_places.hpp"

namespace ex9000::sim {

namespace {

Led led_of(const SimulatedModule& module) {
  if (!module.powered()) {
    return Led::Off;
  }
  switch (module.module().led_pattern()) {
    case StatusLed::Pattern::HostTimeout:
      return Led::HostTimeout;
    case StatusLed::Pattern::SettingsUnreadable:
      return Led::SettingsUnreadable;
    case StatusLed::Pattern::Steady:
      break;
  }
  return Led::On;
}

bool listens(const SimulatedModule& module) { return module.powered() && module.module().listening(); }

Plate plate_of(const SimulatedModule& module) {
  Plate plate;
  plate.switched_on = module.switched_on();
  plate.powered = module.powered();
  plate.init = module.init_asserted();
  plate.led = led_of(module);
  plate.outputs = module.outputs();
  plate.inputs = static_cast<std::uint16_t>(module.input_levels() & module.model().input_mask());
  plate.watchdog_resets = module.watchdog_resets();
  plate.listening = listens(module);
  if (plate.listening) {
    const InForce& in_force = module.module().state().in_force;
    plate.init_mode = in_force.init_mode;
    plate.address = in_force.address;
    plate.mode = {baud_rate(in_force.baud_code), line_format(in_force.baud_code)};
    plate.protocol = in_force.protocol;
    plate.checksum = in_force.checksum;
    for (unsigned channel = 0; channel < module.model().outputs; ++channel) {
      plate.timers[channel] = module.module().state().output_timers.left(channel);
    }
  }
  return plate;
}

InputRecords gathered_of(const SimulatedModule& module) {
  const Inputs& inputs = module.module().state().inputs;
  InputRecords records{inputs.latched_high(), inputs.latched_low(), {}};
  for (unsigned channel = 0; channel < module.model().inputs; ++channel) {
    records.counters[channel] = inputs.counter(channel);
  }
  return records;
}

HostWatchdogState host_watchdog_of(const SimulatedModule& module, VirtualTime now) {
  const State& state = module.module().state();
  HostWatchdogState host_watchdog;
  host_watchdog.enabled = state.settings.watchdog_enabled;
  host_watchdog.timed_out = state.settings.timeout_status;
  host_watchdog.timeout = state.settings.watchdog_timeout;
  host_watchdog.reset_status = state.reset_status;
  const Deadline expiry = module.module().host_watchdog_expiry();
  // Rounds `now` down to microseconds, like the firmware's clock, so that `expires` stays the same until the
  // watchdog is restarted.
  const auto since = std::chrono::duration_cast<std::chrono::microseconds>(now);
  const Time core_now(static_cast<std::uint32_t>(since.count()));
  if (expiry.armed() && !expiry.reached(core_now)) {
    host_watchdog.expires = since + std::chrono::microseconds(expiry.remaining(core_now).microseconds());
  }
  return host_watchdog;
}

/// Reads the copies, and selects the copy that a reset would load (wire.md section 8).
Stored stored_of(const SimulatedModule& module) {
  Stored stored;
  stored.settings = Settings::factory(module.model());
  stored.blank = true;
  std::uint16_t newest = 0;
  for (const std::uint16_t place : hal::kPlaces) {
    const Bytes room{module.memory().contents().data() + place, kRecordRoom};
    const auto read = read_record(module.model(), room);
    const Bytes bytes = room.first(read ? record_size(room) : hal::kEepromPage);
    stored.blank = stored.blank && hal::is_blank(bytes);
    if (read && (!stored.current || is_later(read->sequence, newest))) {
      stored.current = stored.copies.size();
      stored.settings = read->settings;
      newest = read->sequence;
    }
    Stored::Copy& copy = stored.copies.emplace_back();
    copy.bytes.assign(bytes.begin(), bytes.end());
    if (read) {
      copy.sequence = read->sequence;
    }
  }
  return stored;
}

}  // namespace

bool operator==(const Plate& a, const Plate& b) {
  const auto all = [](const Plate& p) {
    return std::tie(p.switched_on, p.powered, p.init, p.listening, p.init_mode, p.address, p.mode.baud,
                    p.mode.format, p.protocol, p.checksum, p.led, p.outputs, p.inputs, p.timers,
                    p.watchdog_resets);
  };
  return all(a) == all(b);
}

bool operator==(const InputRecords& a, const InputRecords& b) {
  return a.latched_high == b.latched_high && a.latched_low == b.latched_low && a.counters == b.counters;
}

bool operator==(const HostWatchdogState& a, const HostWatchdogState& b) {
  const auto all = [](const HostWatchdogState& g) {
    return std::tie(g.enabled, g.timed_out, g.timeout, g.expires, g.reset_status);
  };
  return all(a) == all(b);
}

/// Compares only the bytes of the copies, because all other members depend on them.
bool operator==(const Stored& a, const Stored& b) { return a.copies == b.copies; }

Face face_of(const SimulatedModule& module, VirtualTime now) {
  if (!listens(module)) {
    return {plate_of(module), {}, {}, stored_of(module)};
  }
  return {plate_of(module), gathered_of(module), host_watchdog_of(module, now), stored_of(module)};
}

std::string_view led_text(Led led) {
  constexpr std::array<std::string_view, 4> kTexts{"off", "on", "flashing", "flashing: settings unreadable"};
  return kTexts[static_cast<std::size_t>(led)];  // in the order of Led
}

std::string name_text(const Settings& settings) {
  const Bytes name = settings.name.bytes();
  return {name.begin(), name.end()};
}

}  // namespace ex9000::sim
