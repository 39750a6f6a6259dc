// The words in which the program and the page in sim/panel/page talk: JSON.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/face/face.hpp"
#include "sim/faults/faults.hpp"
#include "sim/frame_watch.hpp"
#include "sim/panel/heard.hpp"

namespace ex9000::sim {

using Message = nlohmann::ordered_json;

/// What the page needs to draw a module's plate, and what never changes.
Message plate_layout(const Model& model);

// A face in parts, as they change on their own.
Message message_of(const Plate& plate);
/// Of the first `inputs` counters.
Message message_of(const Gathered& gathered, unsigned inputs);
Message message_of(const Guard& guard);
Message message_of(const Stored& stored);

/// `first`: the position of the line's first module, from 0.
Message message_of(const std::vector<Faults::Told>& faults, std::size_t first);

/// `modules`: how many the line has; who else is on it is a stranger.
Message message_of(const Heard::Entry& entry, std::uint64_t number, std::size_t modules);

/// What the page asks for.
struct Asked {
  std::uint64_t id = 0;             ///< its own, for the reply
  std::string command;              ///< of the control socket
  std::optional<std::string> undo;  ///< likewise: carried out when the page goes without asking for it
};

/// Nothing: `text` is no such message.
std::optional<Asked> asked_in(const std::string& text);

/// As it goes over the socket; what is no UTF-8 is replaced.
std::string text_of(const Message& message);

}  // namespace ex9000::sim
