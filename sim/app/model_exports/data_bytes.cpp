#include "sim/app/model_exports/data_bytes.hpp"

#include <algorithm>
#include <vector>

#include "firmware/dcon/writing.hpp"

namespace ex9000::sim {

namespace {

/// Returns the position of the data byte that contains a channel: formats a reply in which only this channel
/// is on, and finds the byte that is not 0.
std::size_t data_byte_of(const Model& model, bool is_output, unsigned channel) {
  const auto on = static_cast<std::uint16_t>(1U << channel);
  Reply reply;
  reply.clear();
  dcon::put_data(model, is_output ? on : std::uint16_t{0}, is_output ? std::uint16_t{0} : on, reply);
  const auto digit =
      std::find_if(reply.bytes().begin(), reply.bytes().end(), [](std::uint8_t c) { return c != '0'; });
  return static_cast<std::size_t>(digit - reply.bytes().begin()) / 2;
}

}  // namespace

std::string data_byte(const Model& model, std::size_t byte) {
  for (const bool is_output : {true, false}) {
    std::vector<std::string> held;
    for (unsigned channel = 0; channel < (is_output ? model.outputs : model.inputs); ++channel) {
      if (data_byte_of(model, is_output, channel) == byte) {
        held.push_back(std::to_string(channel));
      }
    }
    if (!held.empty()) {
      return (is_output ? "DO" : "DI") + held.front() + (held.size() > 1 ? "-" + held.back() : "");
    }
  }
  return "00";
}

}  // namespace ex9000::sim
