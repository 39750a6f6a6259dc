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

/// Sends requests through the master of the line, one at a time. After each request, waits for its reply or
/// for the turn-around time, as a serial device server does. Keeps the order of the requests, and leaves the
/// silence that modules require between frames. None of the functions blocks. All times are in the virtual
/// time of the line.
///
/// Other programs can use the line at the same time: they send through the same master, but not through this
/// queue. A request first waits while the master sends or a byte is on the wires. If there has been a byte on
/// the wires, and the last one did not belong to a reply to this queue, the request also waits until the line
/// has settled (Line::unsettled). These two waits together take at most kReplyTimeout. The other programs do
/// not wait for this queue. If one of them sends while a request is in progress, the request gets no reply.
class RequestQueue final : private Station {
 public:
  /// The usual Request::timeout, and the longest wait for a line that others use. This is more than twice the
  /// time within which a module that stores settings must begin its reply (wire.md section 7).
  static constexpr VirtualTime kReplyTimeout = std::chrono::milliseconds(500);
  /// The turn-around time: after a request that expects no reply, the queue waits for this time, so that
  /// modules can process the request (Modbus over Serial Line V1.02, 2.4.1: 100 ms to 200 ms).
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
    /// The maximum time from the end of the request to the end of the first byte of its reply.
    VirtualTime timeout = kReplyTimeout;
    /// Returns whether `frame` is the reply. The queue ignores damaged frames, and frames for which this
    /// function returns false. If this function is empty, the first frame is the reply, even a damaged one.
    std::function<bool(Bytes frame)> is_reply;
    /// The queue calls this function exactly once, unless the owner is destroyed before the queue sends the
    /// request, or the queue is destroyed before the call.
    std::function<void(const Reply& reply)> done;
    std::weak_ptr<void> owner;  ///< the client; must not be empty
  };

  /// Attaches this object to Wires and the master of `line`. This object must live as long as they are
  /// used.
  explicit RequestQueue(Line& line);
  RequestQueue(const RequestQueue&) = delete;
  RequestQueue& operator=(const RequestQueue&) = delete;

  /// Sends the request when all earlier requests are done.
  void ask(Request request);
  /// Returns whether a request waits or is in progress.
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
