// A master and a module on a line with noise, and a witness that hears what the module hears.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sim/faults/noise.hpp"
#include "sim/line.hpp"
#include "tests/firmware/noise/onlooker.hpp"

namespace ex9000::noise {

using FrameBytes = std::vector<std::uint8_t>;

enum class Check { Crc, Sum, None };
const char* name_of(Check check);

/// Counts of frames.
struct Tally {
  std::uint64_t sent = 0;
  std::uint64_t damaged = 0;
  std::uint64_t in_data = 0;          ///< damaged in data bits alone
  std::uint64_t taken_in_data = 0;    ///< of those, taken for frames all the same
  double expected = 0;                ///< how many that should have been
  std::uint64_t taken_otherwise = 0;  ///< likewise, start or stop bits being damaged
  std::uint64_t storing = 0;          ///< taken, and commands to store something
};

class NoisyLine final : public sim::Disturbance, public sim::Station {
 public:
  static constexpr std::uint32_t kBaud = 115200;
  /// A line of more than bit errors has one master that keeps silent before a request, or others.
  NoisyLine(Check check, std::uint64_t seed);

  sim::Line& line() { return line_; }
  sim::Noise& noise() { return noise_; }
  std::mt19937_64& random() { return random_; }
  unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }

  /// One more on the line, which lives as long as that.
  template <class AStation, class... Arguments>
  AStation& attach(Arguments&&... arguments) {
    const auto station = std::make_shared<AStation>(line_.bus(), std::forward<Arguments>(arguments)...);
    others_.push_back(station);
    return *station;
  }

  /// One that the master may send: it reads or writes outputs.
  FrameBytes a_request();
  /// Sends `request` where bits are flipped with this probability, and judges all that follows. Failures are
  /// GoogleTest's.
  void exchange(const FrameBytes& request, double flipped_bit, Tally& tally);
  /// Nobody disturbs any more: after a silence, and a CR where frames end with one, the first frame is
  /// answered, and rightly.
  void expect_the_first_clean_frame_is_answered();

  /// Replies and changes of outputs, all of them with their reason: whatever the module does is held against
  /// what it has heard, whoever sent that.
  [[nodiscard]] std::uint64_t deeds() const { return onlooker_.deeds(); }

  // --- sim::Disturbance: counts what noise does ---
  sim::Levels disturbed(const Sent& sent) override;

  // --- sim::Station: the witness ---
  [[nodiscard]] sim::VirtualTime next() const override { return sim::kNever; }
  void run() override {}
  [[nodiscard]] std::uint32_t baud() const override { return kBaud; }
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
