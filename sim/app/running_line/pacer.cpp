#include "sim/app/running_line/pacer.hpp"

#include <algorithm>
#include <utility>

#include "firmware/line/crc16.hpp"
#include "sim/text/durations.hpp"

namespace ex9000::sim {

namespace {

/// With so many bytes waiting, masters have to wait, as if the buffer of their UART were full.
constexpr std::size_t kMostWaiting = 4096;

/// How far virtual time may be ahead: else watchdogs expire early after many consecutive transactions.
constexpr std::chrono::milliseconds kFarthestAhead{5};

/// A master may notice this delay of a reply, and a user must be able to find the reason.
constexpr VirtualTime kReportedDelay = std::chrono::milliseconds(20);

}  // namespace

Pacer::Pacer(boost::asio::io_context& io, Line& line, LinePorts& ports, FrameWatch* frames, Pace pace,
             LinePorts::Notice notice)
    : timer_(io), line_(line), notice_(std::move(notice)), ports_(ports), frames_(frames), pace_(pace) {}

void Pacer::start(std::function<void()> begun) {
  begun_ = std::move(begun);
  began_ = std::chrono::steady_clock::now();
  first_ = line_.clock().virtual_now();
  ports_.report_mismatches();
  held_ = ports_.hold_line();
  if (held_) {
    notice_("line time waits until a master has connected");
  }
  for (const auto& port : ports_.all()) {
    port->start(*this);
  }
  if (!held_) {
    begin();
  }
}

void Pacer::connected() {
  if (held_ && !ports_.hold_line()) {
    began_ = std::chrono::steady_clock::now();
    held_ = false;
    begin();
  }
}

void Pacer::begin() {
  if (begun_) {
    begun_();
  }
  follow();
}

bool Pacer::requests(std::size_t /*size*/, std::function<void()> process) {
  now(process);
  return !pause_if_full();
}

void Pacer::left(Port::Sender sender) { line_.master().drop(sender); }

VirtualTime Pacer::wall() const {
  if (held_) {
    return first_;
  }
  const VirtualTime real = std::chrono::steady_clock::now() - began_;
  return first_ + (pace_.speed == 1 ? real : std::chrono::duration_cast<VirtualTime>(real * pace_.speed));
}

/// On the wall clock; unless the speed is 1, at most a century after the start: its range is finite.
std::chrono::steady_clock::time_point Pacer::when(VirtualTime time) const {
  constexpr VirtualTime kCentury = std::chrono::hours(24 * 365 * 100);
  const VirtualTime ahead = time - first_;
  if (pace_.speed == 1) {
    return began_ + ahead;
  }
  const auto real = ahead / pace_.speed;
  return began_ + (real < kCentury ? std::chrono::duration_cast<VirtualTime>(real) : kCentury);
}

/// Also later events that need not wait. The line's clock stays at the last event: see Pace::host_latency.
void Pacer::catch_up(VirtualTime until) {
  VirtualTime next = line_.wires().next();
  report_delay(next);
  for (; next <= until || leads(next); next = line_.wires().next()) {
    line_.wires().run_next(pace_.lead == VirtualTime(0) ? until : kNever);
  }
}

/// The event at `next` need not wait for the wall clock.
bool Pacer::leads(VirtualTime next) const {
  return pace_.lead != VirtualTime(0) &&
         (line_.wires().carries() || next <= line_.spacing().last_byte() + pace_.lead);
}

/// Masters have to wait: many bytes wait for the line, or virtual time is too far ahead.
bool Pacer::is_full() const {
  return line_.master().waiting() >= kMostWaiting || line_.clock().virtual_now() > wall() + kFarthestAhead;
}

void Pacer::follow() {
  const VirtualTime present = wall();
  catch_up(present);
  ports_.hand_out();
  if (frames_ != nullptr) {
    frames_->run(present);  // an event that has become due after `present` may continue a frame
  }
  if (paused_ && !is_full()) {
    paused_ = false;
    ports_.resume();
  }
  arm_timer();
}

/// Returns whether masters wait.
bool Pacer::pause_if_full() {
  if (is_full()) {
    paused_ = true;
    arm_timer();
  }
  return paused_;
}

void Pacer::arm_timer() {
  if (held_) {
    return;
  }
  VirtualTime next = std::min(line_.wires().next(), frames_ == nullptr ? kNever : frames_->next());
  if (paused_ && line_.clock().virtual_now() > wall()) {
    next = std::min(next, line_.clock().virtual_now() - kFarthestAhead);
  }
  if (next >= timer_expires_) {
    return;  // a call of `follow` that is too early costs less than a change of the timer
  }
  timer_expires_ = next;
  timer_.expires_at(when(next));
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      timer_expires_ = kNever;
      follow();
    }
  });
}

/// A later delay only if at least twice as long as the last one reported: a busy host causes many.
void Pacer::report_delay(VirtualTime next) {
  if (next > wall()) {
    return;
  }
  const auto delay = std::chrono::duration_cast<VirtualTime>((wall() - next) / pace_.speed);
  if (delay >= kReportedDelay && delay >= 2 * longest_delay_) {
    longest_delay_ = delay;
    notice_("the host was late by " +
            time_text(std::chrono::duration_cast<std::chrono::milliseconds>(delay)) +
            ": modules reply later, and separate frames of a master may reach them as one frame");
  }
}

void Pacer::report_joined(Bytes bytes) {
  const Bytes rest = bytes.from(first_frame_size(bytes));
  if (rest.size != 0 && crc16(rest).value() == 0) {
    notice_(
        "two Modbus frames were read in one piece, and modules treat them as one frame: the master left no "
        "silence between them, or the host was late");
  }
}

void Pacer::reach_present() {
  const VirtualTime present = wall();
  catch_up(present);
  line_.wires().run_until(std::max(present, line_.clock().virtual_now()));
}

void Pacer::now(const std::function<void()>& action) {
  reach_present();
  action();
  follow();
}

bool Pacer::bytes(const Port& port, Bytes bytes, const Port::Positions& damaged, Port::Sender sender) {
  const VirtualTime travelled = port.is_a_line() ? line_.master().takes(bytes.size) : VirtualTime(0);
  const auto latency = std::chrono::duration_cast<VirtualTime>(pace_.host_latency * pace_.speed);
  const VirtualTime written = wall() - latency - travelled;
  catch_up(written);
  line_.wires().run_until(std::max(written, line_.clock().virtual_now()));
  ports_.take_rate(port);
  Bytes rest = bytes;
  const bool splits = pace_.lead != VirtualTime(0) && damaged.empty();
  if (!splits) {
    report_joined(rest);
  }
  while (rest.size != 0) {
    const Bytes piece = rest.first(splits ? first_frame_size(rest) : rest.size);
    line_.master().send(piece.data, piece.size, earliest_frame(piece[0]), damaged, sender);
    rest = rest.from(piece.size);
    if (rest.size != 0) {
      catch_up(wall());
    }
  }
  follow();
  return !pause_if_full();
}

/// Many masters send on at once after a request without a reply, and both may be read in one piece. The first
/// frame is the shortest prefix of at least 4 bytes with a correct CRC. If there is none, or the CRC of all
/// bytes is correct, they are one frame.
std::size_t Pacer::first_frame_size(Bytes bytes) {
  constexpr std::size_t kShortest = 4;
  Crc16 crc;
  std::size_t first = bytes.size;
  for (std::size_t i = 0; i < bytes.size; ++i) {
    crc.add(bytes[i]);
    if (crc.value() == 0 && i + 1 >= kShortest && first == bytes.size) {
      first = i + 1;
    }
  }
  return crc.value() == 0 ? bytes.size : first;
}

/// See Pace::keep_frames_apart. It may be in the past.
VirtualTime Pacer::earliest_frame(std::uint8_t address) const {
  if (!pace_.keep_frames_apart) {
    return VirtualTime(0);
  }
  const FrameSpacing& spacing = line_.spacing();
  if (spacing.master_was_last()) {
    return pace_.lead == VirtualTime(0) ? VirtualTime(0) : spacing.after_own();
  }
  return spacing.after_others(address);
}

}  // namespace ex9000::sim
