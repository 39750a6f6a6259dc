// A session: what a master and a person at the terminals do to one module, played on the firmware and on the
// reference.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tests/oracles/reference/module.hpp"
#include "tests/oracles/reference/rules.hpp"
#include "tests/support/core_target.hpp"

namespace ex9000::reference {

/// The master sends these bytes without a gap, at the rate that the reference has, with silence behind them.
struct Send {
  Bytes bytes;
  /// Where this gets no answer, the next request follows while the module may still be storing.
  bool hurried = false;
};
struct Wait {
  std::chrono::milliseconds time;
};
/// Until so long before the host watchdog expires, where it runs.
struct WaitForExpiry {
  std::chrono::milliseconds before;
};
struct Reset {};
struct Power {
  bool on;
};
struct Init {
  bool asserted;
};
struct Input {
  unsigned channel;
  bool level;
};
struct Pulse {
  unsigned channel;
  std::uint32_t count;
};

using Step = std::variant<Send, Wait, WaitForExpiry, Reset, Power, Init, Input, Pulse>;

/// A module by either description, from factory settings. Waits where they could differ in nothing but the
/// moment that the host watchdog expires, which is settled to a tick and not to the nanosecond.
class Session {
 public:
  explicit Session(const ModelRow& row);

  /// Plays a step on both and compares reply, outputs and LED. False: they differ, and the transcript's last
  /// lines say how. A request whose answer the specification leaves open is not sent.
  bool play(const Step& step);

  [[nodiscard]] const Module& reference() const { return reference_; }
  /// What was played, as a conformance transcript (tests/conformance/README.md).
  [[nodiscard]] std::string transcript() const;
  /// What the reference decided by, in the words of rules.cpp.
  [[nodiscard]] std::vector<std::string> rules() const;
  /// Requests that were sent.
  [[nodiscard]] std::uint64_t transactions() const { return transactions_; }
  /// Of these, those that were over less than 0.1 s before the host watchdog expired, and those that came
  /// while its expiry was being stored.
  [[nodiscard]] std::uint64_t before_expiry() const { return before_expiry_; }
  [[nodiscard]] std::uint64_t behind_expiry() const { return behind_expiry_; }
  /// Requests that were not sent, as the specification leaves them open.
  [[nodiscard]] std::uint64_t left_open() const { return left_open_; }

 private:
  bool play_step(const Send& send);
  bool play_step(const Wait& wait);
  bool play_step(const WaitForExpiry& wait);
  bool play_step(const Reset& reset);
  bool play_step(const Power& power);
  bool play_step(const Init& init);
  bool play_step(const Input& input);
  bool play_step(const Pulse& pulse);

  bool stored();
  bool settle(Time needed);
  bool compare();
  bool listen(std::chrono::milliseconds time);
  bool differs(const std::string& expected, const std::string& got);
  bool follow();
  bool nothing_more();
  [[nodiscard]] std::string lacking(unsigned channel) const;
  [[nodiscard]] std::string sent_line(const Bytes& bytes) const;
  [[nodiscard]] std::string reply_line(const Bytes& bytes) const;
  [[nodiscard]] Time takes(std::size_t bytes) const;

  Module reference_;
  runner::CoreTarget target_;
  /// The module may be storing what it was sent last.
  bool storing_ = false;
  /// Likewise, that the host watchdog has expired.
  bool storing_timeout_ = false;
  Time timeout_stored_{0};  ///< by then the latest one's status is, whatever was asked meanwhile
  unsigned rate_ = 9600;
  bool checksum_ = false;
  std::vector<std::string> lines_;
  std::vector<std::string> rules_;
  std::uint64_t transactions_ = 0;
  std::uint64_t before_expiry_ = 0;
  std::uint64_t behind_expiry_ = 0;
  std::uint64_t left_open_ = 0;
};

/// The fewest of these steps that still make a difference, found by taking away; `steps` make one.
std::vector<Step> shrink(const ModelRow& row, std::vector<Step> steps);

/// The transcript of all these steps, up to where they differ.
std::string transcript_of(const ModelRow& row, const std::vector<Step>& steps);

}  // namespace ex9000::reference
