#include "sim/panel/messages.hpp"

#include <chrono>

#include "sim/frames/frame_errors.hpp"
#include "sim/frames/frame_meaning.hpp"
#include "sim/line/module_spec.hpp"
#include "sim/module_view/terminals.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

std::int64_t microseconds(VirtualTime time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(time).count();
}

std::string_view protocol_text(Protocol protocol) { return protocol == Protocol::Ascii ? "ascii" : "modbus"; }

Message message_of(const Settings& settings) {
  Message message;
  message["address"] = settings.address;
  message["baud"] = baud_rate(settings.baud_code);
  message["protocol"] = protocol_text(settings.protocol);
  message["checksum"] = (settings.format & kFormatChecksum) != 0;
  message["edge"] = (settings.format & kFormatRisingEdge) != 0 ? "rising" : "falling";
  message["name"] = name_text(settings);
  message["powerOn"] = settings.power_on_value;
  message["safe"] = settings.safe_value;
  message["watchdog"] = settings.watchdog_enabled;
  message["timeout"] = settings.watchdog_timeout;
  message["timedOut"] = settings.timeout_status;
  return message;
}

}  // namespace

Message plate_layout(const Model& model) {
  Message layout;
  layout["model"] = model.designation;
  layout["description"] = model.description;
  layout["modbus"] = model.speaks_modbus();
  layout["inputs"] = Message::array();
  for (unsigned channel = 0; channel < model.inputs; ++channel) {
    layout["inputs"].push_back(input_terminal(channel));
  }
  layout["outputs"] = Message::array();
  for (unsigned channel = 0; channel < model.outputs; ++channel) {
    layout["outputs"].push_back(output_terminal(model, channel));
  }
  layout["initTerminal"] = has_init_terminal(model);
  return layout;
}

Message message_of(const Plate& plate) {
  Message message;
  message["switch"] = plate.switched_on;
  message["powered"] = plate.powered;
  message["init"] = plate.init;
  message["listening"] = plate.listening;
  if (plate.listening) {
    message["initMode"] = plate.init_mode;
    message["address"] = plate.address;
    message["baud"] = plate.baud;
    message["protocol"] = protocol_text(plate.protocol);
    message["checksum"] = plate.checksum;
  }
  message["led"] = led_text(plate.led);
  message["outputs"] = plate.outputs;
  message["inputs"] = plate.inputs;
  message["resets"] = plate.watchdog_resets;
  return message;
}

Message message_of(const InputRecords& gathered, unsigned inputs) {
  Message message;
  message["high"] = gathered.latched_high;
  message["low"] = gathered.latched_low;
  message["counters"] = Message::array();
  for (unsigned channel = 0; channel < inputs; ++channel) {
    message["counters"].push_back(gathered.counters[channel]);
  }
  return message;
}

Message message_of(const HostWatchdogState& guard) {
  Message message;
  message["enabled"] = guard.enabled;
  message["timedOut"] = guard.timed_out;
  message["timeout"] = guard.timeout;
  message["expires"] = guard.expires ? Message(microseconds(*guard.expires)) : Message();
  message["resetStatus"] = guard.reset_status;
  return message;
}

Message message_of(const Stored& stored) {
  Message message;
  message["copies"] = Message::array();
  for (std::size_t copy = 0; copy < stored.copies.size(); ++copy) {
    Message each;
    each["bytes"] = hex_text(stored.copies[copy].bytes);
    each["sequence"] = stored.copies[copy].sequence ? Message(*stored.copies[copy].sequence) : Message();
    each["old"] = kPlaces[copy].old;
    message["copies"].push_back(std::move(each));
  }
  message["current"] = stored.current ? Message(*stored.current) : Message();
  message["blank"] = stored.blank;
  message["settings"] = message_of(stored.settings);
  return message;
}

Message message_of(const std::vector<Faults::Info>& faults, std::size_t first) {
  Message message = Message::array();
  for (const Faults::Info& fault : faults) {
    Message each;
    each["number"] = fault.number;
    each["text"] = fault.text;
    each["module"] = fault.module ? Message(first + *fault.module) : Message();
    each["strikes"] = fault.strikes;
    each["soFar"] = fault.strikes_so_far;
    message.push_back(std::move(each));
  }
  return message;
}

Message message_of(const RecentTraffic::Entry& entry, std::uint64_t number, std::size_t modules) {
  const Frame& frame = entry.frame;
  Message message;
  message["number"] = number;
  message["began"] = microseconds(frame.began);
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

std::optional<PageRequest> parse_page_request(const std::string& text) {
  constexpr std::size_t kLongest = 1000;
  const Message message = Message::parse(text, nullptr, false);
  if (!message.is_object()) {
    return std::nullopt;
  }
  const auto id = message.find("id");
  const auto command = message.find("do");
  const auto undo = message.find("undo");
  const bool undone = undo != message.end();
  if (message.size() != (undone ? 3 : 2) || id == message.end() || !id->is_number_unsigned() ||
      command == message.end() || !command->is_string() || (undone && !undo->is_string())) {
    return std::nullopt;
  }
  PageRequest request{id->get<std::uint64_t>(), command->get<std::string>(), std::nullopt};
  if (undone) {
    request.undo = undo->get<std::string>();
  }
  if (request.command.size() > kLongest || (request.undo && request.undo->size() > kLongest)) {
    return std::nullopt;
  }
  return request;
}

std::string text_of(const Message& message) {
  return message.dump(-1, ' ', false, Message::error_handler_t::replace);
}

}  // namespace ex9000::sim
