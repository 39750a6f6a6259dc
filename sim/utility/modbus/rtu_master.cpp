#include <algorithm>
#include <array>

#include "firmware/line/crc16.hpp"
#include "sim/utility/modbus/master.hpp"

namespace ex9000::utility {

namespace {

constexpr std::size_t kCrcSize = 2;

/// The frame that begins so, without its CRC, or nothing: noise or the echo of the request may precede it.
/// `size`: of the frame; 0: the byte after `begin` counts those between it and the CRC.
Data frame_in(const Data& received, const Data& begin, std::size_t size) {
  for (auto at = received.begin();; ++at) {
    at = std::search(at, received.end(), begin.begin(), begin.end());
    const auto left = static_cast<std::size_t>(received.end() - at);
    if (left <= begin.size()) {
      return {};
    }
    const std::size_t whole =
        size != 0 ? size : begin.size() + 1 + at[static_cast<std::ptrdiff_t>(begin.size())] + kCrcSize;
    if (whole <= left && crc16({&*at, whole}).value() == 0) {
      return {at, at + static_cast<std::ptrdiff_t>(whole - kCrcSize)};
    }
  }
}

bool begins_with(const Data& bytes, const Data& beginning) {
  return bytes.size() >= beginning.size() && std::equal(beginning.begin(), beginning.end(), bytes.begin());
}

class RtuMaster final : public Master {
 public:
  RtuMaster(Connection& connection, hal::SerialMode mode)
      : connection_(connection), character_(longest_character(mode)) {}

  Data exchange(const Addressee& to, const Request& request, Time patience) override {
    wait_for_silence();
    Data frame = to.request;
    frame.insert(frame.end(), request.pdu.begin(), request.pdu.end());
    append_crc(frame);
    connection_.send(frame);

    const std::size_t size = request.reply_size == 0 ? 0 : to.reply.size() + request.reply_size + kCrcSize;
    const std::size_t exception_size = to.reply.size() + 2 + kCrcSize;
    Data reply = to.reply;
    Data exception = to.reply;
    reply.insert(reply.end(), request.reply.begin(), request.reply.end());
    exception.push_back(request.pdu[0] | kExceptionBit);
    const Time end =
        connection_.now() + patience + character_ * (frame.size() + (size == 0 ? kLongestFrame : size));
    const bool echo_looks_like_reply = size == frame.size() && begins_with(frame, reply);
    Data received;
    heard_ = Heard::Nothing;
    while (received.size() < kMostBytes) {
      const Data more = connection_.receive(end - connection_.now());
      if (more.empty()) {
        break;
      }
      received.insert(received.end(), more.begin(), more.end());
      const bool echo = begins_with(received, frame);
      if (!echo_looks_like_reply) {
        echoes_ = echo;
      }
      const Data heard(received.begin() + (echo && echoes_ ? static_cast<std::ptrdiff_t>(frame.size()) : 0),
                       received.end());
      for (const auto& [begin, length] : {std::pair{&reply, size}, std::pair{&exception, exception_size}}) {
        const Data found = frame_in(heard, *begin, length);
        if (!found.empty()) {
          return {found.begin() + static_cast<std::ptrdiff_t>(to.reply.size()), found.end()};
        }
      }
    }
    heard_ = heard_of(received, frame);
    return {};
  }

  Connection& connection() override { return connection_; }
  void set_mode(hal::SerialMode mode) override { character_ = longest_character(mode); }

 private:
  static constexpr std::chrono::microseconds kShortestSilence{1750};
  // A line that is never silent must not keep `exchange` for ever.
  static constexpr std::size_t kLongestFrame = 256;
  static constexpr std::size_t kMostBytes = 1000;
  static constexpr unsigned kMostReadings = 100;

  void wait_for_silence() {
    const Time silence = std::max<Time>(character_ * 7 / 2, kShortestSilence);
    for (unsigned i = 0; i < kMostReadings && !connection_.receive(silence).empty(); ++i) {
    }
  }

  Connection& connection_;
  Time character_;
};

}  // namespace

void append_crc(Data& frame) {
  const Crc16 crc = crc16({frame.data(), frame.size()});
  frame.push_back(crc.low_byte());
  frame.push_back(crc.high_byte());
}

std::unique_ptr<Master> rtu_master(Connection& connection, hal::SerialMode mode) {
  return std::make_unique<RtuMaster>(connection, mode);
}

}  // namespace ex9000::utility
