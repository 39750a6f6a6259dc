// Tests that stations receive the same bytes as receivers that sample every bit of the whole traffic. The
// Wires samples for a station only if the station cannot get a byte unchanged.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "firmware/model/baud.hpp"
#include "sim/virtual_line/wires/wires.hpp"
#include "tests/support/environment.hpp"

namespace ex9000::sim {
namespace {

struct Received {
  std::uint8_t byte;
  ByteStatus status;
  VirtualTime at;

  bool operator==(const Received& other) const {
    return byte == other.byte && status == other.status && at == other.at;
  }
  friend std::ostream& operator<<(std::ostream& out, const Received& received) {
    return out << unsigned{received.byte} << " status " << static_cast<int>(received.status) << " at "
               << received.at.count() << " ns";
  }
};

/// The disturbances in the traffic of a test. Each `double` is a probability.
struct Trouble {
  const char* name;
  double noise = 0;                ///< that a byte arrives with random levels
  double collision = 0;            ///< that a station begins to send although Wires is busy
  double cut_off = 0;              ///< that a driver is disabled during a byte
  double other_rate = 0;           ///< that a station sends, or a receiver listens, at a random rate
  double stray = 0;                ///< that a station sends a byte without enabling its driver
  double other_format = 0;         ///< that a station sends, or a receiver listens, in a random format
  std::uint32_t times_faster = 1;  ///< the factor of all rates of the line

  friend std::ostream& operator<<(std::ostream& out, const Trouble& trouble) { return out << trouble.name; }
};

using Random = std::mt19937_64;

bool happens(Random& random, double probability) {
  return std::uniform_real_distribution<double>(0, 1)(random) < probability;
}

VirtualTime between(Random& random, VirtualTime least, VirtualTime most) {
  return VirtualTime(std::uniform_int_distribution<std::int64_t>(least.count(), most.count())(random));
}

constexpr hal::SerialMode kUsualMode{9600, LineFormat::k8N1};

hal::SerialMode some_mode(Random& random, const Trouble& trouble) {
  hal::SerialMode mode = kUsualMode;
  if (happens(random, trouble.other_rate)) {
    mode.baud = kBaudRates[random() % kBaudRates.size()];
  }
  if (happens(random, trouble.other_format)) {
    mode.format = static_cast<LineFormat>(random() % 4);
  }
  return mode;
}

/// Changes some bytes, and records the waves of all bytes.
class Recorder final : public Disturbance {
 public:
  Recorder(const VirtualClock& clock, Random& random, const Trouble& trouble)
      : clock_(clock), random_(random), trouble_(trouble) {}

  Levels disturbed(const Sent& sent) override {
    const Levels levels =
        happens(random_, trouble_.noise) ? static_cast<Levels>(random_() & kIdleLevels) : sent.levels;
    waves.push_back(
        {clock_.virtual_now(), {sent.mode.baud * trouble_.times_faster, sent.mode.format}, levels});
    return levels;
  }

  Waves waves;

 private:
  const VirtualClock& clock_;
  Random& random_;
  const Trouble& trouble_;
};

/// Sends bursts of random bytes with random gaps between the bursts, and always listens.
class Talker final : public Station {
 public:
  Talker(Wires& wires, Recorder& recorder, Random& random, const Trouble& trouble)
      : wires_(wires), end_(wires.attach(*this)), recorder_(recorder), random_(random), trouble_(trouble) {
    end_.listen(kUsualMode);
    rest();
  }

  void run() override {
    if (cuts_off_) {
      recorder_.waves[wave_].cut_off = wires_.clock().virtual_now();
    }
    if (cuts_off_ || (driving_ && left_ == 0)) {
      driving_ = cuts_off_ = false;
      end_.drive(false);
      rest();
    } else if (driving_ || !wires_.busy() || happens(random_, trouble_.collision)) {
      send();
    } else {
      rest();
    }
  }
  void receive(std::uint8_t byte, ByteStatus status) override {
    received.push_back({byte, status, wires_.clock().virtual_now()});
  }

  std::vector<Received> received;

 private:
  void rest() {
    left_ = 1 + random_() % 12;
    mode_ = some_mode(random_, trouble_);
    end_.run_at(wires_.clock().virtual_now() +
                between(random_, VirtualTime(1), std::chrono::milliseconds(20)));
  }
  void send() {
    const VirtualTime now = wires_.clock().virtual_now();
    driving_ = true;
    end_.drive(true);
    wave_ = recorder_.waves.size();
    end_.put({static_cast<std::uint8_t>(random_()), mode_});
    --left_;
    const VirtualTime takes = end_.takes(1, mode_);
    cuts_off_ = happens(random_, trouble_.cut_off);
    end_.run_at(now + (cuts_off_ ? between(random_, VirtualTime(1), takes - VirtualTime(1)) : takes));
  }

  Wires& wires_;
  WireEnd& end_;
  Recorder& recorder_;
  Random& random_;
  const Trouble& trouble_;
  bool driving_ = false;
  bool cuts_off_ = false;
  std::size_t left_ = 0;
  hal::SerialMode mode_ = kUsualMode;
  std::size_t wave_ = 0;
};

/// Puts bytes on the wires without enabling its driver, like a source of noise.
class Stray final : public Station {
 public:
  Stray(Wires& wires, Random& random, const Trouble& trouble)
      : wires_(wires), end_(wires.attach(*this)), random_(random), trouble_(trouble) {
    run();
  }

  void run() override {
    if (happens(random_, trouble_.stray)) {
      end_.put({static_cast<std::uint8_t>(random_()), some_mode(random_, trouble_)});
    }
    end_.run_at(wires_.clock().virtual_now() +
                between(random_, VirtualTime(1), std::chrono::milliseconds(20)));
  }

 private:
  Wires& wires_;
  WireEnd& end_;
  Random& random_;
  const Trouble& trouble_;
};

/// Receives bytes. Changes its rate and format, or stops listening, at random times.
class RetunedListener final : public Station {
 public:
  struct Period {
    VirtualTime begins;
    hal::SerialMode mode;
    std::vector<Received> received = {};
  };

  RetunedListener(Wires& wires, Random& random, const Trouble& trouble)
      : clock_(wires.clock()), end_(wires.attach(*this)), random_(random), trouble_(trouble) {
    run();
  }

  void run() override {
    const hal::SerialMode mode = happens(random_, 0.1) ? hal::SerialMode{} : some_mode(random_, trouble_);
    if (periods.empty() || begins_anew(periods.back().mode, mode)) {
      periods.push_back({clock_.virtual_now(), mode});
    }
    end_.listen(mode);
    end_.run_at(clock_.virtual_now() + between(random_, VirtualTime(1), std::chrono::milliseconds(500)));
  }
  void receive(std::uint8_t byte, ByteStatus status) override {
    periods.back().received.push_back({byte, status, clock_.virtual_now()});
  }

  std::vector<Period> periods;

 private:
  /// Returns whether the change begins a new period. If the rate stays the same, a change
  /// between 8N1 and 8N2 does not begin a new period, because a receiver ignores a second stop bit.
  static bool begins_anew(hal::SerialMode from, hal::SerialMode to) {
    const bool parity = has_parity(from.format) || has_parity(to.format);
    return from.baud != to.baud || (parity && from.format != to.format);
  }

  VirtualClock& clock_;
  WireEnd& end_;
  Random& random_;
  const Trouble& trouble_;
};

/// A receiver that samples every bit of the recorded traffic: it waits for the level 0, reads the middle of
/// ten or eleven bits, and has received the byte when the first stop bit is over. If the stop bit is missing,
/// the receiver then waits for the idle level.
class SamplingReceiver {
 public:
  SamplingReceiver(const Waves& waves, hal::SerialMode mode) : waves_(waves), mode_(mode) {}

  /// Returns what the receiver gets if it listens from `begins` to `ends`.
  std::vector<Received> listen(VirtualTime begins, VirtualTime ends) {
    std::vector<Received> received;
    VirtualTime now = begins;
    while (const auto start = find(false, now, ends)) {
      now = *start + bits(1);
      if (level(now)) {
        continue;  // not a start bit
      }
      unsigned byte = 0;
      unsigned ones = 0;
      for (unsigned bit = 0; bit < 8; ++bit) {
        const bool one = level(*start + bits(2 * bit + 3));
        byte |= one ? 1U << bit : 0U;
        ones += one ? 1U : 0U;
      }
      const bool has_parity_bit = mode_.format == LineFormat::k8E1 || mode_.format == LineFormat::k8O1;
      ones += has_parity_bit && level(*start + bits(19)) ? 1U : 0U;
      now = *start + bits(has_parity_bit ? 21 : 19);
      const bool stop_bit = level(now);
      const VirtualTime at = *start + bits(has_parity_bit ? 22 : 20);
      if (at > ends) {
        break;
      }
      const bool right_parity = !has_parity_bit || (ones % 2 == 1) == (mode_.format == LineFormat::k8O1);
      const ByteStatus without_stop_bit = ones == 0 ? ByteStatus::Break : ByteStatus::FramingError;
      const ByteStatus with_stop_bit = right_parity ? ByteStatus::Good : ByteStatus::ParityError;
      received.push_back({static_cast<std::uint8_t>(byte), stop_bit ? with_stop_bit : without_stop_bit, at});
      if (!stop_bit) {
        const auto idle = find(true, now, ends);
        if (!idle) {
          break;
        }
        now = *idle;
      }
    }
    return received;
  }

 private:
  /// Returns the duration of `halves` half bits.
  [[nodiscard]] VirtualTime bits(unsigned halves) const {
    return VirtualTime(std::int64_t{halves} * 1'000'000'000 / (2 * std::int64_t{mode_.baud}));
  }

  [[nodiscard]] bool level(VirtualTime at) const {
    for (std::size_t i = first_; i < waves_.size() && waves_[i].start <= at; ++i) {
      if (!waves_[i].level(at)) {
        return false;
      }
    }
    return true;
  }

  /// Returns the first time with the level `wanted`, from `from` on and before `until`; nullopt if there is
  /// none. Advances `first_` to the first wave that ends after `from`.
  std::optional<VirtualTime> find(bool wanted, VirtualTime from, VirtualTime until) {
    while (first_ < waves_.size() && waves_[first_].end <= from) {
      ++first_;
    }
    for (VirtualTime at = from; at < until; at = edge_after(at)) {
      if (level(at) == wanted) {
        return at;
      }
    }
    return std::nullopt;
  }

  /// Returns the first time after `at` at which the level can change; kNever if there is none.
  [[nodiscard]] VirtualTime edge_after(VirtualTime at) const {
    VirtualTime edge = kNever;
    for (std::size_t i = first_; i < waves_.size() && waves_[i].start < edge; ++i) {
      for (unsigned bit = 0; bit <= waves_[i].bits(); ++bit) {
        if (waves_[i].boundary(bit) > at) {
          edge = std::min(edge, waves_[i].boundary(bit));
        }
      }
      if (waves_[i].cut_off > at) {
        edge = std::min(edge, waves_[i].cut_off);
      }
    }
    return edge;
  }

  const Waves& waves_;
  hal::SerialMode mode_;
  std::size_t first_ = 0;
};

constexpr std::chrono::seconds kDuration{15};

/// Returns what a receiver gets if it samples every bit from `begins` to `ends`.
std::vector<Received> sampled(const Recorder& recorder, const Trouble& trouble, hal::SerialMode mode,
                              VirtualTime begins, VirtualTime ends) {
  return SamplingReceiver(recorder.waves, {mode.baud * trouble.times_faster, mode.format})
      .listen(begins, ends);
}

class Reception : public testing::TestWithParam<Trouble> {};

/// Expects that, in random traffic, each talker and each listener receives the same bytes as a sampling
/// receiver. Returns the number of compared bytes.
std::size_t compare(const Trouble& trouble, std::uint64_t seed) {
  Random random(seed);
  VirtualClock clock;
  Wires wires(clock, trouble.times_faster);
  Recorder recorder(clock, random, trouble);
  wires.disturb(recorder);
  std::vector<std::unique_ptr<Talker>> talkers;
  std::vector<std::unique_ptr<RetunedListener>> listeners;
  for (unsigned i = 0; i < 3; ++i) {
    talkers.push_back(std::make_unique<Talker>(wires, recorder, random, trouble));
    listeners.push_back(std::make_unique<RetunedListener>(wires, random, trouble));
  }
  Stray stray(wires, random, trouble);
  wires.run_until(kDuration);

  std::size_t compared = 0;
  for (const auto& talker : talkers) {
    EXPECT_EQ(talker->received, sampled(recorder, trouble, kUsualMode, VirtualTime(0), kDuration));
    compared += talker->received.size();
  }
  for (const auto& listener : listeners) {
    for (std::size_t i = 0; i < listener->periods.size(); ++i) {
      const RetunedListener::Period& period = listener->periods[i];
      if (period.mode.baud == 0) {
        EXPECT_TRUE(period.received.empty());
        continue;
      }
      const VirtualTime ends =
          i + 1 < listener->periods.size() ? listener->periods[i + 1].begins : VirtualTime(kDuration);
      EXPECT_EQ(period.received, sampled(recorder, trouble, period.mode, period.begins, ends))
          << period.mode.baud << " baud, format " << static_cast<int>(period.mode.format) << ", from "
          << period.begins.count() << " ns on";
      compared += period.received.size();
    }
  }
  return compared;
}

/// The environment variable EX9000_RECEPTION_SEEDS sets the number of seeds; the default is 1.
TEST_P(Reception, StationsReceiveTheSameAsReceiversThatSampleEveryBit) {
  const std::uint64_t seeds = number_in_environment("EX9000_RECEPTION_SEEDS", 1);
  for (std::uint64_t seed = 1; seed <= seeds && !HasFailure(); ++seed) {
    EXPECT_GT(compare(GetParam(), seed), 5'000U) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(, Reception,
                         testing::Values(Trouble{"none"}, Trouble{"noise", 0.05},
                                         Trouble{"collisions", 0, 0.5}, Trouble{"cut_off_bytes", 0, 0, 0.05},
                                         Trouble{"other_rates", 0, 0, 0, 0.3},
                                         Trouble{"stray_bytes", 0, 0, 0, 0, 0.3},
                                         Trouble{"other_formats", 0, 0, 0, 0, 0, 0.3},
                                         Trouble{"everything", 0.05, 0.5, 0.05, 0.3, 0.3, 0.3},
                                         Trouble{"everything_faster", 0.05, 0.5, 0.05, 0.3, 0.3, 0.3, 1000}),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace ex9000::sim
