#include "sim/pacer.hpp"

#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace ex9000::sim {

namespace {

/// Beyond this many bytes that the line has not carried yet, the master has to wait, as behind a full UART.
constexpr std::size_t kMostWaiting = 4096;

/// Modules are up by then; who reads that the line is there may ask at once.
constexpr VirtualTime kComingUp = std::chrono::milliseconds(100);

/// The kernel may put timers off by 50 us to save power; on a line at 115200 baud that is half a character.
constexpr unsigned long kTimerSlackNanoseconds = 1;

}  // namespace

Pacer::Pacer(boost::asio::io_context& io, Line& line, Pty& pty, BusLog* log, InterCharacterGap gap,
             std::function<void(const std::string&)> notice)
    : timer_(io),
      visits_(io, dup(pty.visits_fd())),
      descriptor_(io, dup(pty.master_fd())),
      line_(line),
      pty_(pty),
      log_(log),
      gap_(gap),
      notice_(std::move(notice)),
      rate_(line.master().baud()) {
  line.bus().observe(*this);
}

void Pacer::start() {
  prctl(PR_SET_TIMERSLACK, kTimerSlackNanoseconds);
  line_.bus().run_for(kComingUp);
  began_ = std::chrono::steady_clock::now() - line_.clock().virtual_now();
  tell_mismatches();
  watch_visits();
  read();
  follow();
}

void Pacer::watch_visits() {
  visits_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                     [this](const boost::system::error_code& error) {
                       if (!error) {
                         pty_.take_visits();
                         watch_visits();
                       }
                     });
}

VirtualTime Pacer::wall() const { return std::chrono::steady_clock::now() - began_; }

/// Runs what is due, and leaves the clock at the last event rather than at `until`: see kHostLatency.
void Pacer::catch_up(VirtualTime until) {
  for (VirtualTime next = line_.bus().next(); next <= until; next = line_.bus().next()) {
    line_.bus().run_until(next);
  }
}

void Pacer::follow() {
  catch_up(wall());
  write_heard();
  if (log_ != nullptr) {
    log_->run(wall());
  }
  if (!reading_ && line_.master().waiting() < kMostWaiting) {
    read();
  }
  arm_timer();
}

void Pacer::arm_timer() {
  const VirtualTime next = std::min(line_.bus().next(), log_ == nullptr ? kNever : log_->next());
  if (next == kNever) {
    return;
  }
  timer_.expires_at(began_ + next);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      follow();
    }
  });
}

void Pacer::read() {
  reading_ = true;
  descriptor_.async_read_some(boost::asio::buffer(buffer_),
                              [this](const boost::system::error_code& error, std::size_t size) {
                                reading_ = false;
                                if (!error) {
                                  on_read(size);
                                  follow();
                                }
                              });
}

void Pacer::on_read(std::size_t size) {
  const VirtualTime written = wall() - kHostLatency;
  catch_up(written);
  line_.bus().run_until(std::max(written, line_.clock().virtual_now()));
  take_rate();
  line_.master().send(buffer_.data(), size, silence_before(buffer_[0]));
}

/// Until when a frame to `address` has to wait so that a module that has heard the last one takes it for
/// another.
VirtualTime Pacer::silence_before(std::uint8_t address) {
  if (gap_ == InterCharacterGap::Refused || last_speaker_ == 0) {
    return VirtualTime(0);
  }
  const InForce& speaker = line_.module(last_speaker_ - 1).module().state().in_force;
  if (speaker.protocol == Protocol::Ascii || speaker.address == address) {
    return VirtualTime(0);
  }
  return last_byte_ + std::chrono::microseconds(LineTiming::at(rate_).rtu_silence.microseconds());
}

void Pacer::driver(std::size_t /*station*/, bool /*on*/, VirtualTime /*now*/) {}

void Pacer::byte(std::size_t station, std::uint8_t /*byte*/, std::uint32_t /*baud*/, bool /*collided*/,
                 VirtualTime /*start*/, VirtualTime end) {
  last_speaker_ = station;
  last_byte_ = end;
}

/// What nobody reads is lost, as on wires; the pseudo-terminal holds some 4 KiB before that.
void Pacer::write_heard() {
  if (!heard_.empty() && pty_.visited()) {
    [[maybe_unused]] const ssize_t written = write(pty_.master_fd(), heard_.data(), heard_.size());
  }
  heard_.clear();
}

void Pacer::take_rate() {
  const auto rate = pty_.baud();
  if (rate && *rate != rate_) {
    rate_ = *rate;
    line_.master().set_baud(rate_);
    tell_mismatches();
  }
}

void Pacer::tell_mismatches() {
  for (std::size_t i = 0; i < line_.size(); ++i) {
    SimulatedModule& module = line_.module(i);
    if (module.baud() != rate_) {
      notice_("the line is at " + std::to_string(rate_) + " baud, " +
              std::string(module.model().designation) + " at " +
              hex_byte_text(module.module().state().in_force.address) + " listens at " +
              std::to_string(module.baud()));
    }
  }
}

}  // namespace ex9000::sim
