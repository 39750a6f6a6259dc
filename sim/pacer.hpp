// Lets a virtual line run along with the wall clock, and connects its master's end to the ports.
#pragma once

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <functional>

#include "sim/frame_watch.hpp"
#include "sim/line.hpp"
#include "sim/runtime/line_ports.hpp"

namespace ex9000::sim {

/// How virtual time and the wall clock go together.
struct Pace {
  /// What a process pays for waking up and reading is not charged to the line: bytes that a master has
  /// written are taken as written up to this much earlier, but never before anything that has happened
  /// already. Without it the host's own delays would add to every transaction.
  VirtualTime host_latency = std::chrono::microseconds(300);
  /// What happens while a byte is under way, or within this time behind one, does not wait for the wall
  /// clock; when virtual time is some milliseconds ahead by that, masters wait. Zero: events happen when the
  /// wall clock has reached them, so a transaction can only take longer than on a real line.
  VirtualTime lead{0};
  /// A frame to another module than the one that has just spoken waits until T3.5 of silence has passed (one
  /// to a Modbus module behind an ASCII answer, until that is given up as a frame). A
  /// master that begins before is heard by the module it has just talked to, which does not hear its own
  /// reply, and by no other: for those the two frames are one. Many masters do so, libmodbus among them, and
  /// get away with it behind adapters that take their time.
  bool keep_frames_apart = true;
  /// Virtual time's to the wall clock's.
  double speed = 1;
};

/// Where bytes take their time.
constexpr Pace kWallPace{};
/// Likewise, for masters that keep to the letter of the standard.
constexpr Pace kStrictWallPace{kWallPace.host_latency, kWallPace.lead, false};
/// Where bytes cost none: from a request to its reply no timer is waited for.
constexpr Pace kInstantPace{VirtualTime(0), std::chrono::microseconds(200), true};

/// Virtual time follows the wall clock from `start` on.
class Pacer final : private BusObserver {
 public:
  /// Puts what `line`'s master hears on all `ports`, and what comes from them on the line. `frames` may be
  /// null. All live as long as `io` runs. `notice`: see LinePorts; it also gets what a late host has changed.
  Pacer(boost::asio::io_context& io, Line& line, const LinePorts::All& ports, FrameWatch* frames, Pace pace,
        LinePorts::Notice notice);

  void start();
  /// From the master's end of the line to the ports; for Line's constructor.
  void hear(std::uint8_t byte) { ports_.hear(byte); }
  /// See LinePorts::sent.
  [[nodiscard]] std::uint64_t sent() const { return ports_.sent(); }
  /// What the line's time is at this moment; its clock shows that of the last event.
  [[nodiscard]] VirtualTime present() const { return std::max(wall(), line_.clock().virtual_now()); }
  /// Does something to the line from outside, at this moment.
  void now(const std::function<void()>& action);

 private:
  [[nodiscard]] VirtualTime wall() const;
  [[nodiscard]] std::chrono::steady_clock::time_point when(VirtualTime time) const;
  void follow();
  void catch_up(VirtualTime until);
  [[nodiscard]] bool leads(VirtualTime next) const;
  [[nodiscard]] bool is_full() const;
  void arm_timer();
  void report_delay(VirtualTime next);
  void report_joined(Bytes bytes);
  bool receive(const Port& port, const std::uint8_t* bytes, std::size_t size);
  static std::size_t first_frame_size(Bytes bytes);
  [[nodiscard]] VirtualTime silence_before(std::uint8_t address);
  [[nodiscard]] bool is_for_modbus(std::uint8_t address);
  void driver(std::size_t /*station*/, bool /*on*/, VirtualTime /*now*/) override {}
  void byte(std::size_t station, std::uint8_t byte, std::uint32_t baud, bool collided, VirtualTime start,
            VirtualTime end) override;

  boost::asio::steady_timer timer_;
  Line& line_;
  LinePorts::Notice notice_;
  LinePorts ports_;
  FrameWatch* frames_;
  Pace pace_;
  std::chrono::steady_clock::time_point began_;
  VirtualTime first_{0};          ///< what the line's clock showed then
  bool paused_ = false;           ///< a port has been told to wait
  VirtualTime longest_delay_{0};  ///< of the host, by the wall clock, that was reported
  std::size_t last_speaker_ = 0;  ///< station; 0: the master
  VirtualTime last_byte_{0};      ///< when its last byte was over
};

}  // namespace ex9000::sim
