#include "sim/virtual_line/line/request_queue.hpp"

#include <algorithm>
#include <utility>

#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

RequestQueue::RequestQueue(Line& line) : line_(line), timer_(line.wires().attach(*this)) {
  line.master().also_receive([this](std::uint8_t byte, ByteStatus status) { hear(byte, status); });
}

void RequestQueue::ask(Request request) {
  const auto first = waiting_.begin() + (state_ == State::Idle ? 0 : 1);
  waiting_.erase(
      std::remove_if(first, waiting_.end(), [](const Request& each) { return each.owner.expired(); }),
      waiting_.end());
  waiting_.push_back(std::move(request));
  if (state_ == State::Idle) {
    send_next();
  }
}

void RequestQueue::send_next() {
  while (!waiting_.empty() && waiting_.front().owner.expired()) {
    waiting_.pop_front();
  }
  if (waiting_.empty()) {
    enter(State::Idle, kNever);
    return;
  }
  deadline_ = line_.clock().virtual_now() + kReplyTimeout;
  send();
}

/// After a reply to this queue an unsettled line does not count: `send` leaves the required silence.
bool RequestQueue::others_use_the_line() const {
  return line_.master().sending() || line_.wires().carries() ||
         (line_.spacing().last_byte() != own_byte_ && line_.unsettled());
}

/// While others use the line, tries again every 1 ms. At the deadline, sends if only other stations use it,
/// but gives up if the master is sending.
void RequestQueue::send() {
  constexpr VirtualTime kBetweenLooks = std::chrono::milliseconds(1);
  Master& master = line_.master();
  const VirtualTime now = line_.clock().virtual_now();
  if (others_use_the_line() && now < deadline_) {
    enter(State::WaitsForLine, now + kBetweenLooks);
    return;
  }
  if (master.sending()) {  // the request would wait for all bytes that the master still has to send
    Reply none;
    none.sent = false;
    finish(none);
    return;
  }
  const Request& request = waiting_.front();
  const FrameSpacing& spacing = line_.spacing();
  const VirtualTime earliest =
      spacing.master_was_last() ? spacing.after_own() : spacing.after_others(request.bytes[0]);
  sent_ = std::max(now, earliest) + master.takes(request.bytes.size());
  deadline_ = sent_ + (request.expects_reply ? request.timeout : kTurnaround);
  reply_ = {};
  enter(request.expects_reply ? State::WaitsForReply : State::TurnsAround, deadline_);
  master.send(request.bytes.data(), request.bytes.size(), earliest);
  taken_ = master.taken();
}

void RequestQueue::hear(std::uint8_t byte, ByteStatus status) {
  constexpr std::size_t kLongestFrame = 256;  // of Modbus RTU; DCON frames are shorter
  const VirtualTime now = line_.clock().virtual_now();
  const bool waits = state_ == State::WaitsForReply || state_ == State::Receives;
  if (!waits || now < sent_) {
    return;
  }
  if (reply_.bytes.empty()) {
    reply_.delay = now - sent_;
  }
  reply_.damaged |= status != ByteStatus::Good;
  VirtualTime ends = now + line_.rtu_silence();
  if (reply_.bytes.size() < kLongestFrame) {
    reply_.bytes.push_back(byte);
  } else {  // too long for a frame; a station that never stops sending must not block the queue
    reply_.damaged = true;
    ends = std::min(ends, std::max(now, deadline_));
  }
  enter(State::Receives, ends);
}

void RequestQueue::run() {
  switch (state_) {
    case State::Idle:
      return;
    case State::WaitsForLine:
      if (waiting_.front().owner.expired()) {
        send_next();
      } else {
        send();
      }
      return;
    case State::WaitsForReply:
    case State::TurnsAround:
      finish({});
      return;
    case State::Receives:
      break;
  }
  if (is_reply()) {
    own_byte_ = line_.spacing().last_byte();
    finish(std::exchange(reply_, {}));
  } else if (line_.clock().virtual_now() < deadline_) {
    reply_ = {};
    enter(State::WaitsForReply, deadline_);
  } else {
    finish({});
  }
}

/// Not if another program has sent since the request: the frame may be the reply to that.
bool RequestQueue::is_reply() const {
  const Request& request = waiting_.front();
  const bool is_for_this_queue = line_.master().taken() == taken_;
  return is_for_this_queue &&
         (!request.is_reply ||
          (!reply_.damaged && request.is_reply({reply_.bytes.data(), reply_.bytes.size()})));
}

/// Sends the next request first: `done` may call `ask`, which must not find the state of this one.
void RequestQueue::finish(const Reply& reply) {
  const Request request = std::move(waiting_.front());
  waiting_.pop_front();
  send_next();
  request.done(reply);
}

void RequestQueue::enter(State state, VirtualTime until) {
  state_ = state;
  timer_.run_at(until);
}

}  // namespace ex9000::sim
