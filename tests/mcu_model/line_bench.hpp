// The RS-485 line of a board: a transceiver and a master. The bench records each character that the board
// sends and each period during which the board drives the line.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "tests/mcu_model/net.hpp"
#include "tests/mcu_model/serial_wire.hpp"
#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

class LineBench {
 public:
  /// A character that the master has received; `started` is the edge of its start bit.
  struct Heard {
    Instant started;
    Instant ended;
    std::uint8_t byte;
    bool good;  ///< the parity and the first stop bit were correct
  };
  /// A period during which the board's driver was on. `to` is kNever while the driver is on.
  struct Driven {
    Instant from;
    Instant to;
  };

  /// `transmit`, `enable` and `receive` are the board's pins. `receive` carries the output of the board's
  /// receiver. If `echo` is true, the board receives the bytes that it sends.
  LineBench(Timeline& timeline, Net& transmit, Net& enable, Net& receive, bool echo = true);

  /// Sets the baud rate of the master, 9600 at first.
  void set_baud(std::uint32_t baud);
  /// Sets the format of the master, 8N1 at first. A character that is being sent keeps its old format; a
  /// character that is being received continues in the new format.
  void set_format(LineFormat format);
  [[nodiscard]] Instant bit_time() const { return bit_time_; }
  [[nodiscard]] Instant character_time() const { return bits_on_wire(format_) * bit_time_; }
  /// Adds characters to the end of the queue. The master sends the characters of the queue without gaps.
  void send(const std::vector<std::uint8_t>& bytes);
  void send_one(Character character);
  [[nodiscard]] bool sending() const { return sender_.busy() || !waiting_.empty(); }
  /// Returns the time at which the last sent character ended.
  [[nodiscard]] Instant sent() const { return sent_; }

  [[nodiscard]] bool driven() const { return enable_.level(); }
  std::vector<Heard> heard;
  std::vector<Driven> drives;
  /// The number of times that the board's transmit pin went low while the board's driver was off. Such a low
  /// level does not appear on the line.
  unsigned bits_lost = 0;
  /// The number of times that the driver went off before the end of the first stop bit of a character. The
  /// tolerance is a tenth of a bit, for the difference of the clocks. On the wires, a second stop bit cannot
  /// be distinguished from the idle line.
  unsigned let_go_early = 0;
  /// The number of times that the driver went off too late: more than one character time after the end of the
  /// last character.
  unsigned let_go_late = 0;

 private:
  void board_speaks();
  void driver_switched();
  void update();
  void go_on();

  Timeline& timeline_;
  Net& transmit_;
  Net& enable_;
  Net& receive_;
  bool echo_;
  bool master_level_ = true;
  LineFormat format_ = LineFormat::k8N1;
  Instant bit_time_{0};
  Instant sent_{0};
  Instant last_safe_{0};   ///< end of the first stop bit of the last received character
  Instant last_ended_{0};  ///< end of the last received character
  std::deque<Character> waiting_;
  SerialSender sender_;
  SerialReceiver ear_;
};

}  // namespace ex9000::registers
