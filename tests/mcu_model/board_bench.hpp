// A board on a bench: an image on its microcontroller, an EEPROM, an RS-485 line with a master, and wires to
// all other pins.
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
  /// Creates a board whose supply is off. `image` must outlive this object.
  explicit BoardBench(const Image& image, I2cBehaviour behaviour = {});
  ~BoardBench();

  void power_on();
  void power_off();
  [[nodiscard]] bool powered() const { return run_.has_value(); }
  /// Resets the microcontroller through its reset pin. The supply must be on.
  void reset();
  /// Runs the image until `when`. If the supply is off, only lets time pass. Throws Fault if the image causes
  /// one. If the image or the watchdog resets the microcontroller, counts the reset in `resets` and
  /// continues.
  void run_until(Instant when);
  void run_for(Instant time) { run_until(timeline.now() + time); }

  [[nodiscard]] std::uint16_t outputs();
  void set_input(unsigned channel, bool level);
  void set_init(bool asserted);
  [[nodiscard]] bool led() { return net(image.status_led).level(); }

  /// Sends a DCON command and its CR. Receives like `exchange`; returns the reply without CR.
  std::string ask(const std::string& command);
  /// Sends `bytes` and waits up to 250 ms for a reply. After the first character of the reply, waits until
  /// about 20 ms pass without a character. Returns the bytes that were received during this call.
  std::vector<std::uint8_t> exchange(const std::vector<std::uint8_t>& bytes);

  Net& net(PinPlace place) { return pins.at(place.port, place.pin); }

  const Image& image;
  Timeline timeline;
  Pins pins;
  std::vector<std::uint8_t> memory;
  EepromChip eeprom;
  LineBench line;
  std::optional<Microcontroller> mcu;
  unsigned resets = 0;  ///< by the watchdog or by software
  unsigned watchdog_resets = 0;
  Instant began{0};  ///< the time of the last reset of any kind
  /// The time at which an output came on for the first time since the last reset of any kind; kNever if no
  /// output has come on since then.
  Instant output_came_on = kNever;
  // A change of these values takes effect at the next reset of any kind.
  Instant crystal_start = std::chrono::milliseconds(2);  ///< how long the crystal takes to start
  bool record = false;                                   ///< whether to record the bus accesses

 private:
  void start(ResetCause cause, std::uint32_t causes_before);
  void restart(ResetCause cause);
  void stop();

  I2cBehaviour behaviour_;
  std::optional<ImageRun> run_;
};

}  // namespace ex9000::registers
