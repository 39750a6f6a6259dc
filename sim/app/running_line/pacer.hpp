// Makes the time of a virtual line follow the wall clock.
#pragma once

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <functional>

#include "sim/app/running_line/line_ports.hpp"
#include "sim/line_monitor/frames/frame_watch.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

struct Pace {
  /// The wall clock time in which the process wakes up and reads: subtracted from the time of a read (with
  /// the transmission time, at a real line), it gives the time at which the master wrote, but never before an
  /// event that has happened. Without it, the host's delays would extend every transaction.
  VirtualTime host_latency = std::chrono::microseconds(300);
  /// While a byte is on the wires, and for `lead` after its end, events do not wait for the wall clock. If
  /// virtual time is then more than 5 ms ahead, masters wait. Zero: every event waits.
  VirtualTime lead{0};
  /// After a Modbus reply of a module that still has power, a frame to another address waits for the silence
  /// that ends a Modbus frame; with `lead`, so does a frame after one of the master. After other bytes that
  /// the master has not sent, a frame to address 0 or to a Modbus module waits until modules no longer add it
  /// to these. Else many masters, such as libmodbus, begin too early after a Modbus reply, and modules that
  /// have heard it take both for one frame. On a real line, a slow adapter usually delays them.
  bool keep_frames_apart = true;
  /// The ratio of virtual time to the wall clock.
  double speed = 1;
};

/// Follows the wall clock from `start` on, or once each port with Port::hold_line has had a master.
class Pacer final : private Arrivals {
 public:
  /// `frames` may be null. `io` must outlive this object; `line`, `ports` and `frames` must live while it
  /// runs. `notice`: of long host delays, and of two Modbus frames in one piece that modules take for one.
  Pacer(boost::asio::io_context& io, Line& line, LinePorts& ports, FrameWatch* frames, Pace pace,
        LinePorts::Notice notice);

  /// Accepts masters, and puts what they send on the line. `begun`: when line time begins.
  void start(std::function<void()> begun = nullptr);
  /// The line's clock has the time of the last event, which may be earlier.
  [[nodiscard]] VirtualTime present() const { return std::max(wall(), line_.clock().virtual_now()); }
  /// Advances the line to its present time; then `action` may use it.
  void now(const std::function<void()>& action);
  /// The two halves of `now`, between which the caller may use several lines.
  void reach_present();
  void follow();

 private:
  [[nodiscard]] VirtualTime wall() const;
  [[nodiscard]] std::chrono::steady_clock::time_point when(VirtualTime time) const;
  void catch_up(VirtualTime until);
  [[nodiscard]] bool leads(VirtualTime next) const;
  [[nodiscard]] bool is_full() const;
  void arm_timer();
  bool pause_if_full();
  void report_delay(VirtualTime next);
  void report_joined(Bytes bytes);
  void begin();
  bool bytes(const Port& port, Bytes bytes, const Port::Positions& damaged, Port::Sender sender) override;
  bool requests(std::size_t size, std::function<void()> process) override;
  void left(Port::Sender sender) override;
  void connected() override;

  static std::size_t first_frame_size(Bytes bytes);
  [[nodiscard]] VirtualTime earliest_frame(std::uint8_t address) const;

  boost::asio::steady_timer timer_;
  VirtualTime timer_expires_ = kNever;  ///< kNever: the timer is not set
  Line& line_;
  LinePorts::Notice notice_;
  LinePorts& ports_;
  FrameWatch* frames_;
  Pace pace_;
  std::chrono::steady_clock::time_point began_;
  VirtualTime first_{0};  ///< the line's time at `began_`
  std::function<void()> begun_;
  bool held_ = false;             ///< line time waits for a master
  bool paused_ = false;           ///< a port waits for `resume`
  VirtualTime longest_delay_{0};  ///< the longest reported delay of the host, in wall clock time
};

}  // namespace ex9000::sim
