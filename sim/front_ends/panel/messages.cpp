#include "sim/front_ends/panel/messages.hpp"

#include <chrono>
#include <utility>

#include "sim/line_monitor/frames/frame_errors.hpp"
#include "sim/line_monitor/frames/frame_meaning.hpp"
#include "sim/line_monitor/module_view/terminals.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

std::int64_t microseconds(VirtualTime time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(time).count();
}

std::string_view protocol_text(Protocol protocol) { return protocol == Protocol::Ascii ? "ascii" : "modbus"; }

Message message_of(const Settings& settings) {
  Message filters = Message::array();
  for (unsigned channel = 0; channel < kMaxInputs; ++channel) {
    filters.push_back(settings.input_filters.of(channel));
  }
  return {{"address", settings.address},
          {"baud", baud_rate(settings.baud_code)},
          {"format", line_format_text(line_format(settings.baud_code))},
          {"protocol", protocol_text(settings.protocol)},
          {"checksum", (settings.format & kFormatChecksum) != 0},
          {"edge", (settings.format & kFormatRisingEdge) != 0 ? "rising" : "falling"},
          {"name", name_text(settings)},
          {"powerOn", settings.power_on_value},
          {"safe", settings.safe_value},
          {"watchdog", settings.watchdog_enabled},
          {"timeout", settings.watchdog_timeout},
          {"timedOut", settings.timeout_status},
          {"responseDelay", settings.response_delay},
          {"fedByRequests", settings.fed_by_requests},
          {"inverted", settings.inverted_inputs},
          {"filters", filters}};
}

}  // namespace

Message plate_layout(const Model& model) {
  Message inputs = Message::array();
  for (unsigned channel = 0; channel < model.inputs; ++channel) {
    inputs.push_back(input_terminal(channel));
  }
  Message outputs = Message::array();
  for (unsigned channel = 0; channel < model.outputs; ++channel) {
    outputs.push_back(output_terminal(model, channel));
  }
  return {{"model", model.designation},
          {"inputs", std::move(inputs)},
          {"outputs", std::move(outputs)},
          {"initTerminal", has_init_terminal(model)}};
}

Message message_of(const Plate& plate) {
  Message message{{"switch", plate.switched_on},
                  {"powered", plate.powered},
                  {"init", plate.init},
                  {"listening", plate.listening}};
  if (plate.listening) {
    message["initMode"] = plate.init_mode;
    message["address"] = plate.address;
    message["baud"] = plate.mode.baud;
    message["format"] = line_format_text(plate.mode.format);
    message["protocol"] = protocol_text(plate.protocol);
    message["checksum"] = plate.checksum;
  }
  message["led"] = led_text(plate.led);
  message["outputs"] = plate.outputs;
  message["inputs"] = plate.inputs;
  message["timers"] = plate.timers;
  message["resets"] = plate.watchdog_resets;
  return message;
}

Message message_of(const InputRecords& records, unsigned inputs) {
  const auto counters = records.counters.begin();
  return {{"high", records.latched_high},
          {"low", records.latched_low},
          {"counters", std::vector<std::uint32_t>(counters, counters + inputs)}};
}

Message message_of(const HostWatchdogState& host_watchdog) {
  return {{"enabled", host_watchdog.enabled},
          {"timedOut", host_watchdog.timed_out},
          {"timeout", host_watchdog.timeout},
          {"expires", host_watchdog.expires ? Message(microseconds(*host_watchdog.expires)) : Message()},
          {"resetStatus", host_watchdog.reset_status}};
}

Message message_of(const Stored& stored) {
  Message copies = Message::array();
  for (const Stored::Copy& copy : stored.copies) {
    copies.push_back(
        {{"bytes", hex_text(copy.bytes)}, {"sequence", copy.sequence ? Message(*copy.sequence) : Message()}});
  }
  return {{"copies", std::move(copies)},
          {"current", stored.current ? Message(*stored.current) : Message()},
          {"blank", stored.blank},
          {"settings", message_of(stored.settings)}};
}

Message message_of(const std::vector<Faults::Info>& faults, std::size_t first) {
  Message message = Message::array();
  for (const Faults::Info& fault : faults) {
    message.push_back({{"number", fault.number},
                       {"text", fault.text},
                       {"module", fault.module ? Message(first + *fault.module) : Message()},
                       {"inProgress", fault.in_progress},
                       {"soFar", fault.occurrences_so_far}});
  }
  return message;
}

Message message_of(const RecentTraffic::Entry& entry, std::uint64_t number, std::size_t modules) {
  const Frame& frame = entry.frame;
  Message message{{"number", number}, {"began", microseconds(frame.began)}};
  if (entry.note) {
    message["note"] = *entry.note;
    return message;
  }
  const bool known = frame.station <= modules;
  message["ended"] = microseconds(frame.ended);
  message["station"] = known ? Message(frame.station) : Message();
  message["bytes"] = hex_text(frame.bytes);
  if (looks_like_dcon(frame.bytes)) {
    message["text"] = shown(frame.bytes);
  }
  const std::string means = frame.collided || !known ? "" : meaning(frame.bytes, frame.speaker());
  const std::string error = known ? errors(frame) : line_error(frame);
  if (!means.empty()) {
    message["meaning"] = means;
  }
  if (!error.empty()) {
    message["error"] = error;
  }
  return message;
}

std::optional<PageRequest> parse_page_request(const Message& message) {
  const auto is_command = [&message](const char* key) {
    constexpr std::size_t kLongest = 1000;
    return message.contains(key) && message[key].is_string() &&
           message[key].get_ref<const std::string&>().size() <= kLongest;
  };
  const bool has_undo = message.contains("undo");
  if (message.size() != (has_undo ? 3 : 2) || !message.contains("id") ||
      !message["id"].is_number_unsigned() || !is_command("do") || (has_undo && !is_command("undo"))) {
    return std::nullopt;
  }
  return PageRequest{message["id"], message["do"], message.value("undo", "")};
}

}  // namespace ex9000::sim
