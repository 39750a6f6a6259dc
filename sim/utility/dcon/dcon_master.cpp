#include "sim/utility/dcon/dcon_master.hpp"

#include <algorithm>
#include <numeric>

#include "sim/text/values.hpp"

namespace ex9000::utility {

namespace {

constexpr std::size_t kChecksumDigits = 2;
/// No reply of a module is longer.
constexpr std::size_t kLongestReply = 40;
// A line that is never silent must not keep `ask` for ever.
constexpr std::size_t kMostBytes = 1000;
constexpr unsigned kMostDrains = 100;

std::string checksum_of(const std::string& text) {
  return sim::hex_byte_text(std::accumulate(
      text.begin(), text.end(), 0U, [](unsigned sum, char c) { return sum + static_cast<std::uint8_t>(c); }));
}

bool is_in(const char* characters, std::uint8_t byte) {
  return std::string(characters).find(static_cast<char>(byte)) != std::string::npos;
}

/// Of a complete reply in what has been received, its text without CR. Before a CR, a delimiter that comes
/// first begins the echo of a command; a lead begins a reply, which may contain delimiters.
std::optional<std::string> reply_in(const Data& received) {
  auto begin = received.begin();
  for (auto end = begin; (end = std::find(begin, received.end(), '\r')) != received.end(); begin = end + 1) {
    const auto first = std::find_if(begin, end, [](std::uint8_t byte) { return is_in("#$%@~!>?", byte); });
    if (first != end && is_in("!>?", *first)) {
      return std::string(first, end);
    }
  }
  return std::nullopt;
}

}  // namespace

Data dcon_frame(const std::string& command, bool checksum) {
  const std::string text = command + (checksum ? checksum_of(command) : "") + "\r";
  return {text.begin(), text.end()};
}

std::optional<std::string> DconMaster::ask(const std::string& command, Time patience) {
  for (unsigned i = 0; i < kMostDrains && !connection_.receive(character_ * 2).empty(); ++i) {
  }
  const Data frame = dcon_frame(command, checksum_);
  connection_.send(frame);
  const Time end = connection_.now() + patience + character_ * (frame.size() + kLongestReply);
  Data received;
  heard_ = Heard::Nothing;
  for (Data more;
       received.size() < kMostBytes && !(more = connection_.receive(end - connection_.now())).empty();) {
    received.insert(received.end(), more.begin(), more.end());
    std::optional<std::string> reply = reply_in(received);
    if (!reply) {
      continue;
    }
    if (!std::all_of(reply->begin(), reply->end(), [](char c) { return c >= ' ' && c <= '~'; })) {
      break;
    }
    if (checksum_) {
      const std::size_t size = reply->size() - std::min(reply->size(), kChecksumDigits);
      if (size == 0 || checksum_of(reply->substr(0, size)) != reply->substr(size)) {
        heard_ = Heard::Noise;
        return std::nullopt;
      }
      reply->resize(size);
    }
    return reply;
  }
  heard_ = heard_of(received, frame);
  return std::nullopt;
}

}  // namespace ex9000::utility
