#include "sim/front_ends/panel/messages.hpp"

#include <utility>

#include "sim/line_monitor/frames/frame_errors.hpp"
#include "sim/line_monitor/frames/frame_meaning.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

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
