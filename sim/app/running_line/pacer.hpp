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

/// The relation between virtual time and the wall clock.
struct Pace {
  /// Compensates for the wall clock time that the process takes to wake up and read. The pacer subtracts this
  /// value from the time at which the program reads bytes, and uses the result as the time at which the
  /// master has written them. If the port is connected to a real line, the pacer also subtracts the
  /// transmission time of the bytes. The result is never before an event that has already happened. Without
  /// this compensation, the host's delays would extend every transaction.
  VirtualTime host_latency = std::chrono::microseconds(300);
  /// While a byte is on the wires, and until `lead` has passed after its end, the pacer processes events
  /// without waiting for the wall clock. If virtual time is then more than 5 ms ahead of the wall clock,
  /// masters have to wait. If `lead` is zero, every event waits for the wall clock.
  VirtualTime lead{0};
  /// After a Modbus reply of a module that still has power, a frame to another address waits until the
  /// silence that ends a Modbus frame has passed. If `lead` is not zero, a frame after a frame of the master
  /// waits for this silence too. After any other bytes that the master has not sent, a frame to address 0 or
  /// to the address of a Modbus module waits until modules no longer treat these bytes as part of the frame.
  /// Without these delays, many masters, for example libmodbus, would begin a frame too early after a Modbus
  /// reply. Modules that have received the reply would then treat the reply and this frame as one frame. On a
  /// real line, a slow adapter usually causes this delay.
  bool keep_frames_apart = true;
  /// The ratio of virtual time to the wall clock.
  double speed = 1;
};

/// Virtual time follows the wall clock from `start` on, or from the time at which each port that holds the
/// line (Port::hold_line) has had a master.
class Pacer final : private Arrivals {
 public:
  /// `frames` may be null. `io` must outlive this object. `line`, `ports` and `frames` must live as long as
  /// `io` runs. `notice` receives messages about long delays of the host, and about two Modbus frames that
  /// were read in one piece and that modules treat as one frame.
  Pacer(boost::asio::io_context& io, Line& line, LinePorts& ports, FrameWatch* frames, Pace pace,
        LinePorts::Notice notice);

  /// Accepts masters, and puts the bytes and the requests from `ports` on the line. Calls `begun` when line
  /// time begins.
  void start(std::function<void()> begun = nullptr);
  /// Returns the line's present time. The line's clock has the time of the last event, which may be earlier.
  [[nodiscard]] VirtualTime present() const { return std::max(wall(), line_.clock().virtual_now()); }
  /// Advances the line to its present time, then runs `action`, which may use the line.
  void now(const std::function<void()>& action);
  /// The two halves of `now`, for an action that uses several lines. Between them, the caller may use the
  /// line.
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
  // --- Arrivals ---
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
