// Requests of several clients on one half-duplex line, one at a time.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

class Line;

/// Sends requests through the line's master as a serial device server does: one at a time, in order, each
/// followed by its reply or the turn-around time, and with the silence that modules require between frames.
/// Nothing blocks. All times are virtual.
///
/// Other programs may send through the same master without this queue. A request waits while the master sends
/// or a byte is on the wires, and then until the line has settled (Line::unsettled), unless the last byte
/// belonged to a reply to this queue or there was none; in all at most kReplyTimeout. The others do not wait
/// for the queue: if one sends while a request is in progress, the request gets no reply.
class RequestQueue final : private Station {
 public:
  /// The usual Request::timeout, and the longest wait for a line that others use: more than twice the time in
  /// which a module that stores settings must begin its reply (wire.md section 7).
  static constexpr VirtualTime kReplyTimeout = std::chrono::milliseconds(500);
  /// Lets modules process a request without a reply (Modbus over Serial Line V1.02, 2.4.1: 100 to 200 ms).
  static constexpr VirtualTime kTurnaround = std::chrono::milliseconds(100);

  struct Reply {
    std::vector<std::uint8_t> bytes;  ///< at most 256; empty: not sent, no reply in time, or none expected
    bool sent = true;                 ///< false: not sent, because the master still had other bytes to send
    bool damaged = false;             ///< a byte had a line error, or more than 256 bytes arrived
    VirtualTime delay{0};             ///< from the end of the request to the end of the first byte of `bytes`
  };

  struct Request {
    std::vector<std::uint8_t> bytes;  ///< the frame on the line, at least one byte
    bool expects_reply = true;
    /// From the end of the request to the end of the reply's first byte.
    VirtualTime timeout = kReplyTimeout;
    /// Picks the reply from the undamaged frames; empty: the first frame is it, even a damaged one.
    std::function<bool(Bytes frame)> is_reply;
    /// Called exactly once, unless `owner` dies before the request is sent, or the queue before the call.
    std::function<void(const Reply& reply)> done;
    std::weak_ptr<void> owner;  ///< the client; must not be empty
  };

  /// This object must live as long as the wires and the master of `line` are used.
  explicit RequestQueue(Line& line);
  RequestQueue(const RequestQueue&) = delete;
  RequestQueue& operator=(const RequestQueue&) = delete;

  void ask(Request request);
  [[nodiscard]] bool busy() const { return state_ != State::Idle; }

 private:
  enum class State {
    Idle,           ///< nothing to send
    WaitsForLine,   ///< the request waits while others use the line, for at most kReplyTimeout
    WaitsForReply,  ///< the request is being sent, or no byte of its reply has arrived yet
    Receives,       ///< bytes of a frame arrive; a silence ends the frame
    TurnsAround,    ///< the request expects no reply; it is being sent, or the turn-around time passes
  };

  void run() override;
  void hear(std::uint8_t byte, ByteStatus status);
  void send_next();
  void send();
  [[nodiscard]] bool others_use_the_line() const;
  [[nodiscard]] bool is_reply() const;
  void finish(const Reply& reply);
  void enter(State state, VirtualTime until);

  Line& line_;
  WireEnd& timer_;
  State state_ = State::Idle;
  std::deque<Request> waiting_;  ///< the first one is in progress, unless the state is Idle or WaitsForLine
  VirtualTime own_byte_{0};      ///< end of the last reply to this queue; 0: none
  std::uint64_t taken_ = 0;      ///< Master::taken after the request was passed to the master
  VirtualTime sent_{0};          ///< end of the last byte of the request
  VirtualTime deadline_{0};      ///< when the wait for the line or the reply, or the turn-around time, ends
  Reply reply_;
};

}  // namespace ex9000::sim
