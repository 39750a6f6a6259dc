#include "sim/front_ends/panel/face.hpp"

#include <string>
#include <string_view>
#include <utility>

#include "hal/eeprom/two_places.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

std::string_view led_text(const SimulatedModule& module) {
  if (!module.powered()) {
    return "off";
  }
  switch (module.module().led_pattern()) {
    case StatusLed::Pattern::HostTimeout:
      return "flashing";
    case StatusLed::Pattern::SettingsUnreadable:
      return "flashing: settings unreadable";
    case StatusLed::Pattern::Steady:
      break;
  }
  return "on";
}

std::string_view protocol_text(Protocol protocol) { return protocol == Protocol::Ascii ? "ascii" : "modbus"; }

/// Null while the module does not listen.
const State* state_of(const SimulatedModule& module) {
  return module.powered() && module.module().listening() ? &module.module().state() : nullptr;
}

template <class ValueOf>
Message list_of(unsigned channels, ValueOf value_of) {
  Message list = Message::array();
  for (unsigned channel = 0; channel < channels; ++channel) {
    list.push_back(value_of(channel));
  }
  return list;
}

Message plate_of(const SimulatedModule& module) {
  const State* const state = state_of(module);
  Message plate{{"switch", module.switched_on()},
                {"powered", module.powered()},
                {"init", module.init_asserted()},
                {"listening", state != nullptr}};
  if (state != nullptr) {
    const InForce& in_force = state->in_force;
    plate.update({{"initMode", in_force.init_mode},
                  {"address", in_force.address},
                  {"serialNumber", hex_long_text(state->serial_number())},
                  {"baud", baud_rate(in_force.baud_code)},
                  {"format", line_format_text(line_format(in_force.baud_code))},
                  {"protocol", protocol_text(in_force.protocol)},
                  {"checksum", in_force.checksum}});
  }
  plate.update({{"led", led_text(module)},
                {"outputs", module.outputs()},
                {"inputs", module.input_levels() & module.model().input_mask()},
                {"timers", list_of(module.model().outputs,
                                   [&](unsigned channel) {
                                     return state != nullptr ? state->output_timers.left(channel) : 0;
                                   })},
                {"resets", module.watchdog_resets()}});
  return plate;
}

/// Zeros while the module does not listen.
Message records_of(const SimulatedModule& module) {
  const State* const state = state_of(module);
  const Inputs inputs = state != nullptr ? state->inputs : Inputs();
  return {{"high", inputs.latched_high()},
          {"low", inputs.latched_low()},
          {"counters",
           list_of(module.model().inputs, [&](unsigned channel) { return inputs.counter(channel); })}};
}

/// `timeout`: in 0.1 s. `expires`: line time in us if no request restarts the watchdog, or null.
/// `resetStatus`: what $AA5 would report.
Message host_watchdog_of(const SimulatedModule& module, VirtualTime now) {
  const State* const state = state_of(module);
  if (state == nullptr) {
    return {{"enabled", false},
            {"timedOut", false},
            {"timeout", 0},
            {"expires", nullptr},
            {"resetStatus", false}};
  }
  const Deadline expiry = module.module().host_watchdog_expiry();
  // Rounded down like the firmware's clock, so that `expires` stays the same until the watchdog is restarted.
  const std::int64_t since = microseconds(now);
  const Time core_now(static_cast<std::uint32_t>(since));
  const bool runs = expiry.armed() && !expiry.reached(core_now);
  return {{"enabled", state->settings.watchdog_enabled},
          {"timedOut", state->settings.timeout_status},
          {"timeout", state->settings.watchdog_timeout},
          {"expires", runs ? Message(since + expiry.remaining(core_now).microseconds()) : Message()},
          {"resetStatus", state->reset_status}};
}

Message message_of(const Settings& settings) {
  const Bytes name = settings.name.bytes();
  return {
      {"address", settings.address},
      {"baud", baud_rate(settings.baud_code)},
      {"format", line_format_text(line_format(settings.baud_code))},
      {"protocol", protocol_text(settings.protocol)},
      {"checksum", (settings.format & kFormatChecksum) != 0},
      {"edge", (settings.format & kFormatRisingEdge) != 0 ? "rising" : "falling"},
      {"name", std::string(name.begin(), name.end())},
      {"powerOn", settings.power_on_value},
      {"safe", settings.safe_value},
      {"watchdog", settings.watchdog_enabled},
      {"timeout", settings.watchdog_timeout},
      {"timedOut", settings.timeout_status},
      {"responseDelay", settings.response_delay},
      {"fedByRequests", settings.fed_by_requests},
      {"inverted", settings.inverted_inputs},
      {"filters", list_of(kMaxInputs, [&](unsigned channel) { return settings.input_filters.of(channel); })}};
}

/// The copies, and the settings that a reset would load (wire.md section 8), else the factory settings.
Message stored_of(const SimulatedModule& module) {
  Message copies = Message::array();
  Message current;
  Settings settings = Settings::factory(module.model());
  bool blank = true;
  std::uint16_t newest = 0;
  for (const std::uint16_t place : hal::kPlaces) {
    const Bytes room{module.memory().contents().data() + place, kRecordRoom};
    const auto read = read_record(module.model(), room);
    const Bytes bytes = room.first(read ? record_size(room) : hal::kEepromPage);
    blank = blank && hal::is_blank(bytes);
    if (read && (current.is_null() || is_later(read->sequence, newest))) {
      current = copies.size();
      settings = read->settings;
      newest = read->sequence;
    }
    copies.push_back({{"bytes", hex_text({bytes.begin(), bytes.end()})},
                      {"sequence", read ? Message(read->sequence) : Message()}});
  }
  return {{"copies", std::move(copies)},
          {"current", std::move(current)},
          {"blank", blank},
          {"settings", message_of(settings)}};
}

}  // namespace

Message face_of(const SimulatedModule& module, VirtualTime now) {
  return {{"plate", plate_of(module)},
          {"records", records_of(module)},
          {"hostWatchdog", host_watchdog_of(module, now)},
          {"stored", stored_of(module)}};
}

PanelLine panel_line(const LineSummary& summary, const Line& line, std::function<VirtualTime()> present) {
  PanelLine shown{summary, {}, std::move(present), {}, {}};
  for (std::size_t i = 0; i < line.size(); ++i) {
    shown.models.push_back(&line.module(i).model());
  }
  shown.face = [&line](std::size_t module) {
    return face_of(line.module(module), line.clock().virtual_now());
  };
  shown.faults = [&line] {
    const Faults* const so_far = line.faults_so_far();
    return so_far == nullptr ? std::vector<Faults::Info>() : so_far->list();
  };
  return shown;
}

Message plate_layout(const Model& model) {
  const bool relays = model.output_kind != OutputKind::OpenCollector;
  const auto output = [=](unsigned channel) {
    return relays ? "RL" + std::to_string(channel + 1) : "DO" + std::to_string(channel);
  };
  return {{"model", model.designation},
          {"inputs", list_of(model.inputs, [](unsigned channel) { return "DI" + std::to_string(channel); })},
          {"outputs", list_of(model.outputs, output)},
          {"initTerminal", model.init_input == InitInput::Terminal}};
}

}  // namespace ex9000::sim
