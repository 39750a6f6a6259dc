// A master and a module on a line with noise, and a witness that receives the same bytes as the module.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sim/virtual_line/faults/noise.hpp"
#include "sim/virtual_line/line/line.hpp"
#include "tests/firmware/noise/onlooker.hpp"

namespace ex9000::noise {

using FrameBytes = std::vector<std::uint8_t>;

enum class Check { Crc, Sum, None };
const char* name_of(Check check);

/// Counts of frames, and an expected value.
struct Tally {
  std::uint64_t sent = 0;
  std::uint64_t damaged = 0;
  std::uint64_t in_data = 0;          ///< only data bits were damaged
  std::uint64_t taken_in_data = 0;    ///< the frames of `in_data` that were accepted as valid
  double expected = 0;                ///< expected value of `taken_in_data`
  std::uint64_t taken_otherwise = 0;  ///< accepted although start or stop bits were damaged
  std::uint64_t storing = 0;          ///< exchanges with an accepted command that may store something
};

class NoisyLine final : public sim::Disturbance, public sim::Station {
 public:
  static constexpr std::uint32_t kBaud = 115200;
  /// Starts a line with a master and a module. The same `seed` reproduces the same noise and requests.
  NoisyLine(Check check, std::uint64_t seed);

  sim::Line& line() { return line_; }
  sim::Noise& noise() { return noise_; }
  std::mt19937_64& random() { return random_; }
  unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }

  /// Creates another station on the line. The station exists as long as this object.
  template <class AStation, class... Arguments>
  AStation& attach(Arguments&&... arguments) {
    const auto station = std::make_shared<AStation>(line_.wires(), std::forward<Arguments>(arguments)...);
    others_.push_back(station);
    return *station;
  }

  /// Returns a random request that reads or writes outputs.
  FrameBytes a_request();
  /// Sends `request` while noise flips each bit with the probability `flipped_bit`. In DCON, then sends an
  /// undamaged CR. Checks the effects, and adds the results to `tally`. If the module has received a command
  /// that may store something, restores the module's original settings and restarts the module. Reports
  /// failures through GoogleTest.
  void exchange(const FrameBytes& request, double flipped_bit, Tally& tally);
  /// Ends the noise and waits. In DCON, also sends a CR, which ends a frame that is still incomplete. Then
  /// checks that the module replies correctly to the next frame.
  void expect_the_first_clean_frame_is_answered();

  /// Returns the number of replies plus the number of changes of outputs. The witness checks that each reply
  /// and each change has a permitted cause, for example a frame that the module received from any sender.
  [[nodiscard]] std::uint64_t replies_and_output_changes() const {
    return onlooker_.replies_and_output_changes();
  }

  // --- sim::Disturbance: counts the effects of the noise ---
  sim::Levels disturbed(const Sent& sent) override;

  // --- sim::Station: receives bytes for the witness ---
  void run() override {}
  void receive(std::uint8_t byte, ByteStatus status) override;

 private:
  void come_up();
  void send(const FrameBytes& bytes, sim::VirtualTime then);
  [[nodiscard]] std::uint16_t outputs() { return line_.module(0).outputs(); }

  Check check_;
  std::vector<sim::ModuleSpec> specs_;
  sim::Line line_;
  sim::Noise noise_;
  std::vector<std::shared_ptr<void>> others_;
  std::mt19937_64 random_;
  FrameBytes to_master_;

  Onlooker onlooker_;
  unsigned flips_in_data_ = 0;
  unsigned flips_in_framing_ = 0;
};

}  // namespace ex9000::noise
