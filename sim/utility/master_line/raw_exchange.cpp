#include "sim/utility/master_line/raw_exchange.hpp"

#include <algorithm>

#include "sim/line_monitor/frames/frame_meaning.hpp"

namespace ex9000::utility {

namespace {

/// Before a frame: T3.5 at 1200 baud.
constexpr std::chrono::milliseconds kSilence{33};

/// Functions whose reply equals the request.
bool has_equal_reply(const Data& request) {
  return request[1] == 0x05 || request[1] == 0x06 || request[1] == 0x08;
}

}  // namespace

void raw_send(Connection& connection, const Data& request) {
  connection.pause(kSilence);
  if (sim::looks_like_dcon(request)) {
    connection.send({'\r'});  // ends what the bytes of a Modbus request may have begun
    connection.pause(kSilence);
  }
  connection.send(request);
}

RawReply raw_exchange(Connection& connection, const Data& request, Time patience, bool echoes) {
  constexpr std::chrono::milliseconds kEnd{50};  // an adapter may hold bytes back for 16 ms
  constexpr std::size_t kLongestReply = 300;
  const std::size_t longest = request.size() + kLongestReply;  // with the echo
  raw_send(connection, request);
  const Time sent = connection.now();
  const Time end = sent + patience;
  const bool dcon = sim::looks_like_dcon(request);
  RawReply reply;
  Data& bytes = reply.bytes;
  while (bytes.size() < longest && (!dcon || bytes.empty() || bytes.back() != '\r' || bytes == request)) {
    const bool waits = bytes.empty() || bytes == request;
    const Data more = connection.receive(waits ? end - connection.now() : Time(kEnd));
    if (more.empty()) {
      break;
    }
    reply.delay = waits ? connection.now() - sent : reply.delay;
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  if (bytes == request) {
    return !dcon && !echoes && has_equal_reply(request) ? reply : RawReply();
  }
  if (bytes.size() > request.size() && std::equal(request.begin(), request.end(), bytes.begin())) {
    bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(request.size()));
  }
  return reply;
}

}  // namespace ex9000::utility
