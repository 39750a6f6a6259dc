// A board as it stands on a bench: an image on its microcontroller, an EEPROM, a line with a master, and
// wires to all the rest.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/mcu_model/eeprom_chip.hpp"
#include "tests/mcu_model/image.hpp"
#include "tests/mcu_model/image_run.hpp"
#include "tests/mcu_model/line_bench.hpp"
#include "tests/mcu_model/microcontroller.hpp"
#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

class BoardBench {
 public:
  /// The supply is off.
  explicit BoardBench(const Image& image, I2cManners manners = {});
  ~BoardBench();

  void power_on();
  void power_off();
  [[nodiscard]] bool powered() const { return run_.has_value(); }
  /// As the reset pin does it.
  void reset();
  /// Throws Fault. Resets that the image or its watchdog brings about are counted, and it runs on.
  void run_until(Instant when);
  void run_for(Instant time) { run_until(timeline.now() + time); }

  [[nodiscard]] std::uint16_t outputs();
  void set_input(unsigned channel, bool level);
  void set_init(bool asserted);
  [[nodiscard]] bool led() { return net(image.status_led).level(); }

  /// Sends a DCON command with its CR and hears the reply until 250 ms pass without a character; without CR.
  std::string ask(const std::string& command);
  /// Likewise, any bytes.
  std::vector<std::uint8_t> exchange(const std::vector<std::uint8_t>& bytes);

  Net& net(PinPlace place) { return pins.at(place.port, place.pin); }

  const Image& image;
  Timeline timeline;
  Pins pins;
  std::vector<std::uint8_t> memory;
  EepromChip eeprom;
  LineBench line;
  std::optional<Microcontroller> mcu;
  unsigned resets = 0;  ///< by the watchdog and the processor
  unsigned watchdog_resets = 0;
  Instant began{0};                 ///< the last reset of any kind
  Instant output_came_on = kNever;  ///< the first of any, since the last reset of any kind
  /// For resets to come.
  Instant crystal_start = std::chrono::milliseconds(2);
  bool record = false;

 private:
  void start();
  void stop();

  I2cManners manners_;
  std::optional<ImageRun> run_;
};

}  // namespace ex9000::registers
