// Tests the recovery of an I2C bus on wires that record their levels. Source: NXP UM10204, 3.1.16 (nine
// clocks), 3.1.4 (START and STOP), table 10 (times of the standard mode).
#include "hal/i2c_bus_recovery.hpp"

#include <gtest/gtest.h>

#include <string>

namespace ex9000::hal {
namespace {

Time now;

/// Records the levels of the wires after each call of `take` and `pull`. `C` is a high clock line, and `c` is
/// a low clock line. `D` is a high data line, and `d` is a low data line. A device on the bus holds the data
/// line low until the clock line has risen `held_for` more times.
struct RecordedWires {
  static inline std::string levels;
  static inline int held_for = 0;
  static inline bool clock_is_pulled = false;
  static inline bool data_is_pulled = false;
  static inline Time changed;

  static void take() { set(false, false); }
  static void pull(bool clock, bool data) {
    constexpr Duration kShortest(5);  // the standard requires at least 4.7 us low and 4.0 us high
    EXPECT_FALSE(now.since(changed) < kShortest && levels.size() > 3) << levels;
    changed = now;
    set(clock, data);
  }
  static bool data_is_high() { return !data_is_pulled && held_for == 0; }

 private:
  static void set(bool clock, bool data) {
    if (clock_is_pulled && !clock && held_for > 0) {
      --held_for;
    }
    clock_is_pulled = clock;
    data_is_pulled = data;
    levels += clock ? "c" : "C";
    levels += data_is_high() ? "D " : "d ";
  }
};

/// Returns the levels of the wires during a recovery. The device releases the data line at the rising edge of
/// clock pulse number `clock`, from 1. If `clock` is 0, the device does not hold the data line.
std::string levels_of_recovery(int clock) {
  RecordedWires::levels.clear();
  RecordedWires::held_for = clock;
  I2cBusRecovery<RecordedWires> recovery;
  recovery.begin();
  while (!recovery.poll(now)) {
    now = now + Duration(1);
  }
  return RecordedWires::levels;
}

/// The result of `Deadline::reached` is correct only within 35 minutes of the deadline. In this test, 40
/// minutes pass between two recoveries.
TEST(I2cBusRecoveryTest, ARecoveryLongAfterThePreviousOneBeginsImmediately) {
  I2cBusRecovery<RecordedWires> recovery;
  for (int pass = 0; pass < 2; ++pass) {
    RecordedWires::levels.clear();
    RecordedWires::held_for = 1;
    recovery.begin();
    EXPECT_FALSE(recovery.poll(now));
    ASSERT_EQ(RecordedWires::levels, "Cd cd ");
    while (!recovery.poll(now)) {
      now = now + Duration(1);
    }
    now = now + milliseconds(40U * 60U * 1000U);
  }
}

const std::string kStartAndStop = "Cd CD ";

TEST(I2cBusRecoveryTest, ABusThatIsFreeGetsOnlyStartAndStop) {
  EXPECT_EQ(levels_of_recovery(0), "CD " + kStartAndStop);
}

TEST(I2cBusRecoveryTest, TheClocksEndWhenTheDeviceReleasesTheDataLine) {
  EXPECT_EQ(levels_of_recovery(1), "Cd cd CD " + kStartAndStop);
  EXPECT_EQ(levels_of_recovery(3), "Cd cd Cd cd Cd cd CD " + kStartAndStop);
  EXPECT_EQ(levels_of_recovery(9),
            "Cd cd Cd cd Cd cd Cd cd Cd cd Cd cd Cd cd Cd cd Cd cd CD " + kStartAndStop);
}

TEST(I2cBusRecoveryTest, ADeviceThatNeverReleasesTheDataLineGetsNineClocks) {
  EXPECT_EQ(levels_of_recovery(1000), "Cd cd Cd cd Cd cd Cd cd Cd cd Cd cd Cd cd Cd cd Cd cd Cd Cd Cd ");
}

}  // namespace
}  // namespace ex9000::hal
