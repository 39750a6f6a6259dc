// A master and a module on a line with noise, and a witness that hears what the module hears.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sim/line.hpp"
#include "sim/faults/noise.hpp"
#include "tests/noise/judges.hpp"

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
  std::uint64_t surprises = 0;        ///< taken, and of effect on the module
};

class NoisyLine final : public sim::Disturbance, public sim::Station, public sim::BusObserver {
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

  /// From now on whatever the module does is held against what it could have heard, whoever sent that.
  void watch() { watching_ = true; }
  /// Replies and changes of outputs that were found to have a reason, since `watch`.
  [[nodiscard]] std::uint64_t reasons() const { return reasons_; }

  // --- sim::Disturbance: counts what noise does ---
  sim::Levels disturbed(const Sent& sent) override;

  // --- sim::Station: the witness ---
  [[nodiscard]] sim::VirtualTime next() const override { return sim::kNever; }
  void run() override {}
  [[nodiscard]] std::uint32_t baud() const override { return kBaud; }
  void receive(std::uint8_t byte, ByteStatus status) override;

  // --- sim::BusObserver ---
  void driver(std::size_t station, bool on, sim::VirtualTime now) override;
  void byte(std::size_t /*station*/, std::uint8_t /*byte*/, std::uint32_t /*baud*/, bool /*collided*/,
            sim::VirtualTime /*start*/, sim::VirtualTime /*end*/) override {}

 private:
  struct Heard {
    Finding finding = Finding::Nothing;
    FrameBytes frame;
  };

  void clear_witness();
  Heard what_was_heard();
  void come_up();
  void send(const FrameBytes& bytes, sim::VirtualTime then);
  void note_right_frame();
  void expect_reason(const char* what);
  /// The outputs that a right frame demands, where it is one of those that the master sends.
  std::optional<std::uint16_t> demanded(const FrameBytes& frame) const;
  [[nodiscard]] std::uint16_t outputs() { return line_.module(0).outputs(); }

  Check check_;
  std::vector<sim::ModuleSpec> specs_;
  sim::Line line_;
  sim::Noise noise_;
  std::vector<std::shared_ptr<void>> others_;
  std::mt19937_64 random_;
  FrameBytes to_master_;

  FrameBytes bytes_;
  std::vector<bool> good_;
  DconJudge dcon_;
  Heard dcon_heard_;
  bool module_drives_ = false;
  unsigned replies_ = 0;
  std::uint16_t expected_outputs_ = 0;
  unsigned flips_in_data_ = 0;
  unsigned flips_in_framing_ = 0;

  bool watching_ = false;
  std::deque<sim::VirtualTime> right_frames_;
  sim::VirtualTime latest_right_frame_{-1'000'000'000};
  std::uint64_t reasons_ = 0;
};

}  // namespace ex9000::noise
