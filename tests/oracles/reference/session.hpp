// Plays a session on the firmware and on the reference. A session consists of the actions of a master and of
// a person who operates the inputs, INIT*, the reset pin and the supply of one module.
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

/// The master sends these bytes without a gap, at the baud rate and in the line format of the reference. Then
/// it listens for a reply.
struct Send {
  Bytes bytes;
  /// Whether the next request may follow while the module is still storing the settings of this request. Has
  /// an effect only if the module runs Modbus and this request gets no reply.
  bool next_may_follow_at_once = false;
};
/// The master sends these bytes in another line format, `format`, and then uses the module's line format
/// again. See `Module::on_bytes` for the formats that are permitted.
struct SendInAnotherFormat {
  LineFormat format;
  Bytes bytes;
};
struct Wait {
  std::chrono::milliseconds time;
};
/// Waits until a given time before the earliest possible expiry of the host watchdog. Does not wait if the
/// host watchdog is not running, or if the wait would be shorter than 1 ms.
struct WaitForExpiry {
  /// The time from the end of the wait to the earliest possible expiry.
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

using Step = std::variant<Send, SendInAnotherFormat, Wait, WaitForExpiry, Reset, Power, Init, Input, Pulse>;

/// Plays steps on a firmware module and on a reference module. Both modules start with factory settings.
/// `extensions`: whether the reference module has the extensions; the firmware always has them. The
/// specification does not define exactly when the module changes by itself, for example when the host
/// watchdog expires. If a result could depend on the exact time of such a change, the session waits until the
/// change is over.
class Session {
 public:
  explicit Session(const ModelRow& row, Extensions extensions = Extensions::Present);

  /// Plays a step on both modules and compares the reply, the time of the reply, the outputs and the LED.
  /// Does not compare the outputs and the LED while the module may be storing the settings of the last
  /// request. Returns false if the modules differ; the last lines of the transcript describe the difference.
  /// Does not send a request that `left_open` counts.
  bool play(const Step& step);

  [[nodiscard]] const Module& reference() const { return reference_; }
  /// Returns a conformance transcript (tests/conformance/README.md) of the steps that have been played.
  [[nodiscard]] std::string transcript() const;
  /// Returns the rules that the reference has applied, as rules.cpp names them.
  [[nodiscard]] std::vector<std::string> rules() const;
  /// Returns the number of requests that `Send` steps have sent.
  [[nodiscard]] std::uint64_t transactions() const { return transactions_; }
  /// Returns the number of `Send` requests that ended less than 0.1 s before the host watchdog could expire.
  [[nodiscard]] std::uint64_t before_expiry() const { return before_expiry_; }
  /// Returns the number of `Send` requests that were sent while the module might be storing the timeout
  /// status after an expiry of the host watchdog.
  [[nodiscard]] std::uint64_t behind_expiry() const { return behind_expiry_; }
  /// Returns the number of requests that were not sent because the reference cannot predict what the module
  /// does, or because the master could not read the reply.
  [[nodiscard]] std::uint64_t left_open() const { return left_open_; }

 private:
  bool play_step(const Send& send);
  bool play_step(const SendInAnotherFormat& send);
  bool play_step(const Wait& wait);
  bool play_step(const WaitForExpiry& wait);
  bool play_step(const Reset& reset);
  bool play_step(const Power& power);
  bool play_step(const Init& init);
  bool play_step(const Input& input);
  bool play_step(const Pulse& pulse);

  bool stored();
  bool changes_within(Time needed);
  bool settle(Time needed);
  bool compare();
  bool listen(std::chrono::milliseconds time);
  bool differs(const std::string& expected, const std::string& got);
  bool follow();
  void set_format(LineFormat format);
  bool nothing_more();
  [[nodiscard]] std::string lacking(unsigned channel) const;
  [[nodiscard]] std::string sent_line(const Bytes& bytes) const;
  [[nodiscard]] std::string reply_line(const Bytes& bytes) const;
  [[nodiscard]] Time takes(std::size_t bytes) const { return takes(bytes, format_); }
  [[nodiscard]] Time takes(std::size_t bytes, LineFormat format) const;
  [[nodiscard]] Time heard_in(std::size_t bytes) const;

  Module reference_;
  runner::CoreTarget target_;
  /// Whether the module may be storing the settings of the last request.
  bool storing_ = false;
  /// Whether the module may be storing the timeout status after an expiry of the host watchdog.
  bool storing_timeout_ = false;
  /// The time by which the module has stored the timeout status after the latest expiry. A request resets
  /// `storing_timeout_`, but not this time.
  Time timeout_stored_{0};
  unsigned rate_ = 9600;
  LineFormat format_ = LineFormat::k8N1;
  bool checksum_ = false;
  std::vector<std::string> lines_;
  std::vector<std::string> rules_;
  std::uint64_t transactions_ = 0;
  std::uint64_t before_expiry_ = 0;
  std::uint64_t behind_expiry_ = 0;
  std::uint64_t left_open_ = 0;
};

/// Removes steps that are not necessary to make the two modules differ, and returns the remaining steps.
/// `steps` must make the two modules differ.
std::vector<Step> shrink(const ModelRow& row, std::vector<Step> steps, Extensions extensions);

/// Returns the transcript of these steps, up to the first difference.
std::string transcript_of(const ModelRow& row, const std::vector<Step>& steps, Extensions extensions);

}  // namespace ex9000::reference
