// The RS-485 line of a board: a transceiver, and a master with an ear for every character and for how long
// the board drives the line.
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
  /// A character that the master has heard; `started` is its start bit's edge.
  struct Heard {
    Instant started;
    Instant ended;
    std::uint8_t byte;
    bool good;
  };
  /// A time for which the board's driver was on.
  struct Driven {
    Instant from;
    Instant to;
  };

  /// `transmit`, `enable`, `receive`: the board's pins. `receive_level` is told what its receiver shows.
  LineBench(Timeline& timeline, Net& transmit, Net& enable, Net& receive, bool echo = true);

  void set_baud(std::uint32_t baud);
  [[nodiscard]] Instant bit_time() const { return bit_time_; }
  /// Puts characters on the line behind those that wait already, without a gap.
  void send(const std::vector<std::uint8_t>& bytes);
  void send_one(Character character);
  [[nodiscard]] bool sending() const { return sender_.busy() || !waiting_.empty(); }
  /// When the last character that was sent was over.
  [[nodiscard]] Instant sent() const { return sent_; }

  [[nodiscard]] bool driven() const { return enable_.level(); }
  std::vector<Heard> heard;
  std::vector<Driven> drives;
  /// What the board sends is on the line only while its driver is on. Not 0: bits began without it.
  unsigned bits_lost = 0;
  /// How often its driver went off before the last stop bit was over, but for a tenth of a bit that clocks
  /// may differ by; and how often it stayed on for more than a character behind it.
  unsigned let_go_early = 0;
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
  Instant bit_time_{0};
  Instant sent_{0};
  Instant last_ended_{0};  ///< of what was heard
  std::deque<Character> waiting_;
  SerialSender sender_;
  SerialReceiver ear_;
};

}  // namespace ex9000::registers
