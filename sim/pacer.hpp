// Lets a virtual line run along with the wall clock, and connects its master's end to a pseudo-terminal.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sim/bus_log.hpp"
#include "sim/line.hpp"
#include "sim/pty.hpp"

namespace ex9000::sim {

/// Virtual time follows the wall clock from `start` on and never runs ahead of it: events happen when the
/// wall clock has reached them, so a transaction can only take longer than on a real line.
///
/// What a process pays for waking up and reading is not charged to the line: bytes that a master has written
/// are taken as written up to kHostLatency earlier, but never before anything that has happened already.
/// Without it the host's own delays would add to every transaction.
///
/// A master that begins to send before T3.5 of silence has passed is heard by the module it has just talked
/// to, which does not hear its own reply, and by no other: for those the two frames are one. Many masters do
/// so, libmodbus among them, and get away with it behind adapters that take their time. So does this end:
/// where a frame goes to another address than that of the module that has just spoken, it waits until the
/// silence is over - unless the line is to keep to the letter of the standard.
class Pacer final : private BusObserver {
 public:
  static constexpr std::chrono::microseconds kHostLatency{300};

  /// Puts what `line`'s master hears on `pty`, and what comes from it on the line. `log` may be null. All
  /// live as long as `io` runs. `notice` gets a line for people for every module that listens at another rate
  /// than the line's, at the start and whenever that changes.
  Pacer(boost::asio::io_context& io, Line& line, Pty& pty, BusLog* log, InterCharacterGap gap,
        std::function<void(const std::string&)> notice);

  void start();
  /// From the master's end of the line to the pseudo-terminal; for Line's constructor.
  void hear(std::uint8_t byte) { heard_.push_back(byte); }

 private:
  [[nodiscard]] VirtualTime wall() const;
  void follow();
  void catch_up(VirtualTime until);
  void arm_timer();
  void watch_visits();
  void read();
  void on_read(std::size_t size);
  void write_heard();
  void take_rate();
  void tell_mismatches();
  [[nodiscard]] VirtualTime silence_before(std::uint8_t address);
  void driver(std::size_t station, bool on, VirtualTime now) override;
  void byte(std::size_t station, std::uint8_t byte, std::uint32_t baud, bool collided, VirtualTime start,
            VirtualTime end) override;

  boost::asio::steady_timer timer_;
  boost::asio::posix::stream_descriptor visits_;
  boost::asio::posix::stream_descriptor descriptor_;
  Line& line_;
  Pty& pty_;
  BusLog* log_;
  InterCharacterGap gap_;
  std::function<void(const std::string&)> notice_;
  std::chrono::steady_clock::time_point began_;
  std::array<std::uint8_t, 4096> buffer_{};
  std::vector<std::uint8_t> heard_;
  bool reading_ = false;
  std::uint32_t rate_;
  std::size_t last_speaker_ = 0;  ///< station; 0: the master
  VirtualTime last_byte_{0};      ///< when its last byte was over
};

}  // namespace ex9000::sim
