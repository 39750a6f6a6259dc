// A second implementation of a module, written from the specification alone and as simply as possible. It
// processes all bytes of a request in one call, has no interrupts, and stores settings immediately. It shares
// no code with the firmware, except the names of the line formats. If this module and the firmware agree on a
// random session, two independent readings of the specification agree. Section, E and D numbers refer to
// wire.md.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "firmware/model/line_format.hpp"
#include "tests/oracles/reference/models.hpp"

namespace ex9000::reference {

using Bytes = std::vector<std::uint8_t>;
/// Time since an arbitrary origin, which must be the same for all calls of one module.
using Time = std::chrono::nanoseconds;
/// wire.md 2: the longest time from power-on or reset until the module listens.
inline constexpr std::chrono::milliseconds kComingUp{100};
/// The longest time from the last byte of a request until its settings are stored. This is the sum of 200 ms
/// for the store (wire.md 3), and about 32 ms for the silence that ends a Modbus frame at 1200 baud
/// (wire.md 7).
inline constexpr std::chrono::milliseconds kLongestStore{232};
/// extensions.md: the longest response delay, in ms.
inline constexpr unsigned kLongestDelay = 0x1E;

/// Returns the number of bits of a character: extensions.md.
constexpr unsigned character_bits(LineFormat format) { return format == LineFormat::k8N1 ? 10 : 11; }
/// Returns whether `code` is a valid CC. A CC combines a baud rate and a line format.
bool baud_code_exists(unsigned code);
/// Returns the line format of a valid CC.
LineFormat format_of(unsigned baud_code);
/// Returns the line format as a transcript names it.
const char* name_of(LineFormat format);

/// wire.md 8: the values that survive a power failure.
struct Stored {
  unsigned address = 0x01;
  unsigned baud_code = 0x06;  ///< bits 5:0: the baud rate; bits 7:6: the line format
  unsigned format = 0x00;     ///< bit 7: rising edges are counted; bit 6: checksum
  bool modbus = false;
  std::string name;
  unsigned power_on = 0;    ///< bit n is channel n
  unsigned safe = 0;        ///< bit n is channel n
  bool enabled = false;     ///< host watchdog enabled
  unsigned timeout = 0xFF;  ///< of the host watchdog, in units of 0.1 s
  bool timed_out = false;   ///< the timeout status
  /// Register 0x0251, 1: every correctly received request with this module's own address restarts the host
  /// watchdog.
  unsigned restarted_by_requests = 0;
  unsigned delay = 0;                  ///< the response delay in ms
  std::array<unsigned, 16> filters{};  ///< the filter times of the inputs, in ms
  unsigned inversion = 0;              ///< bit n is input n
};

inline bool operator==(const Stored& a, const Stored& b) {
  const auto members = [](const Stored& s) {
    return std::tie(s.address, s.baud_code, s.format, s.modbus, s.name, s.power_on, s.safe, s.enabled,
                    s.timeout, s.timed_out, s.restarted_by_requests, s.delay, s.filters, s.inversion);
  };
  return members(a) == members(b);
}

/// The module's reaction to a request.
struct Answer {
  Bytes reply;          ///< empty: no reply
  bool stores = false;  ///< settings change; storing takes up to 200 ms
  /// If not null, the reference cannot predict what the module does; the text says why. The other members are
  /// not valid then.
  const char* left_open = nullptr;
};

/// A module. Its supply is off at first.
class Module {
 public:
  explicit Module(const ModelRow& row, Extensions extensions = Extensions::Present);

  // --- events ---

  /// Sets the stored values. Call this only while the supply is off, because some of the values would take
  /// effect immediately.
  void store(const Stored& stored) {
    stored_ = stored;
    blank_memory_ = false;
  }
  /// Switches the supply. A module that is switched on has 100 ms to start. Its reset is at an unknown time
  /// within these 100 ms.
  void power(bool on, Time now);
  /// Resets the module, which then has 100 ms to start. Has no effect while the supply is off.
  void reset(Time now);
  void set_init(bool asserted) { init_asserted_ = asserted; }
  void set_input(unsigned channel, bool level, Time now);
  void pulse_input(unsigned channel, std::uint32_t count, Time now);
  /// Processes all bytes that the master has sent. The last byte ended at `now`, and a silence follows.
  Answer on_request(const Bytes& bytes, Time now) { return on_bytes(bytes, format(), now); }
  /// Like `on_request`, for a master that uses another line format. If the module uses parity, `sent_in` must
  /// not be 8N1, because the module cannot determine where such bytes end if there is no gap between them.
  Answer on_bytes(const Bytes& bytes, LineFormat sent_in, Time now);
  /// Reports that the first byte of the reply to the last request began at `now`. All effects of the request
  /// are complete by then.
  void replied(Time now);
  /// Lets time pass until `now`, which must not lie within one of the `moments`.
  void pass(Time now);

  // --- visible state ---

  /// Returns the rules that have been applied since the last `take_rules`, as rules.cpp names them.
  [[nodiscard]] const std::vector<std::string>& rules() const { return rules_; }
  std::vector<std::string> take_rules() { return std::exchange(rules_, {}); }

  [[nodiscard]] bool powered() const { return powered_; }
  [[nodiscard]] unsigned outputs() const { return outputs_; }
  /// Returns whether the timeout status is set. The LED of a powered module then flashes (wire.md 6).
  [[nodiscard]] bool led_flashes() const { return stored_.timed_out; }
  [[nodiscard]] unsigned rate() const;
  [[nodiscard]] LineFormat format() const { return format_of(baud_code_); }
  /// Returns the response delay that applies to the next request: its reply starts no earlier than this time
  /// after the last stop bit. The delay is 0 in INIT mode.
  [[nodiscard]] Time reply_delay() const { return std::chrono::milliseconds(init_mode_ ? 0 : stored_.delay); }
  [[nodiscard]] bool runs_modbus() const { return runs_modbus_; }
  [[nodiscard]] bool checksum() const { return checksum_; }
  [[nodiscard]] unsigned address() const { return address_; }
  [[nodiscard]] bool init_mode() const { return init_mode_; }
  [[nodiscard]] bool init_asserted() const { return init_asserted_; }
  /// Returns whether a reset would start or end INIT mode, or would change the protocol, address, baud rate,
  /// line format or checksum in force.
  [[nodiscard]] bool waits_for_reset() const;
  [[nodiscard]] const Stored& stored() const { return stored_; }
  [[nodiscard]] const ModelRow& row() const { return row_; }
  [[nodiscard]] bool has_extensions() const { return extensions_ == Extensions::Present; }

  /// The module changes by itself between these two times. The exact time is unknown if the time of the
  /// cause, for example of a command or a reset, is not visible from outside.
  struct Moment {
    Time earliest;
    Time latest;
  };
  /// Returns when the host watchdog expires, if it is running.
  [[nodiscard]] const std::optional<Moment>& expiry() const { return expiry_; }
  /// Returns all moments at which the module changes by itself: the expiry of the host watchdog, the ends of
  /// the running filter times, and the ends of timed outputs.
  [[nodiscard]] std::vector<Moment> moments() const;
  /// Returns the lowest channel number of the inputs whose filter times are running, if there is one.
  [[nodiscard]] std::optional<unsigned> settling_input() const;

 private:
  void rule(const std::string& rule) { rules_.push_back(rule); }
  /// Returns whether the request requires an extension that this module does not have. In this case, sets
  /// `left_open_`. `needed`: whether the request requires an extension.
  bool refuses_extension(bool needed) {
    const bool refuses = needed && !has_extensions();
    left_open_ = refuses ? "this request requires an extension that the module does not have" : left_open_;
    return refuses;
  }

  // wire.md 2 and 12
  void come_up(Time now);
  unsigned seconds_since_reset();
  // wire.md 5 and 12, inputs.cpp
  [[nodiscard]] unsigned raw_levels() const { return terminals_ ^ stored_.inversion; }
  void edge(unsigned channel, bool rising, std::uint32_t count);
  void take_level(unsigned channel);
  void set_filter(unsigned channel, unsigned milliseconds);
  void set_inversion(unsigned inversion);
  void clear_latches();
  void clear_counter(unsigned channel);
  [[nodiscard]] std::uint32_t counter_modulus() const { return runs_modbus_ ? 65536 : 100000; }
  // wire.md 6 and 12
  void restart_host_watchdog();
  void restart_host_watchdog_by_host_ok();
  void restart_host_watchdog_by_request();
  void clear_timeout_status() { stored_.timed_out = false; }
  [[nodiscard]] unsigned all_outputs() const { return (1U << row_.outputs) - 1; }
  void drive(unsigned channels, unsigned values);
  void set_timed_output(unsigned channel, unsigned time);
  unsigned time_left(unsigned channel);
  void end_timed_outputs(const std::string& by);
  [[nodiscard]] unsigned timed_outputs() const;
  [[nodiscard]] Time executed_by() const;

  // wire.md 3 and 4, dcon.cpp
  enum class Framing { Nothing, Open, ToTheCr };
  std::optional<std::string> dcon_frame(std::string frame, bool spoiled);
  std::string dcon_command(char delimiter, const std::string& body);
  std::string set_configuration(const std::string& body);
  std::string hash_command(const std::string& body);
  std::string set_group_or_single(const std::string& body);
  std::string dollar_command(const std::string& body);
  std::string at_command(const std::string& body);
  std::string tilde_command(const std::string& body);
  std::string set_host_watchdog(const std::string& body);
  std::string set_protocol(const std::string& body);
  void take_sample();
  [[nodiscard]] std::string aa() const;
  [[nodiscard]] std::string first_second(unsigned outputs, unsigned inputs) const;
  [[nodiscard]] bool permission() const { return init_mode_ || init_asserted_; }

  // wire.md 7: modbus.cpp, modbus_map.cpp and modbus_services.cpp
  Bytes modbus_frame(Bytes frame, std::vector<bool> bad);
  Bytes modbus_function(const Bytes& frame);
  Bytes read_bits(const Bytes& frame);
  Bytes read_registers(const Bytes& frame);
  Bytes write_coil(const Bytes& frame);
  Bytes write_coils(const Bytes& frame);
  Bytes write_register(const Bytes& frame);
  Bytes write_registers(const Bytes& frame);
  Bytes diagnostics(const Bytes& frame);
  Bytes server_id(const Bytes& frame);
  Bytes device_identification(const Bytes& frame);
  Bytes function_46(const Bytes& frame);
  [[nodiscard]] bool coil(unsigned address) const;
  void judge_coils(unsigned first, const std::vector<bool>& values, unsigned function);
  void set_coils(unsigned first, const std::vector<bool>& values);
  [[nodiscard]] unsigned register_value(unsigned address);
  void judge_registers(unsigned first, const std::vector<unsigned>& values);
  void set_registers(unsigned first, const std::vector<unsigned>& values);
  bool broadcast_ignored(unsigned first);

  // extensions.md, extension_registers.cpp
  [[nodiscard]] unsigned tally(unsigned index) const;
  unsigned extension_value(unsigned address);
  unsigned extension_word(unsigned address);
  void set_extension(unsigned address, unsigned value);
  std::string delay_command(const std::string& body);
  std::string extension_command(const std::string& body);

  const ModelRow& row_;
  Extensions extensions_;
  std::vector<std::string> rules_;
  Stored stored_;
  bool blank_memory_ = true;  ///< nothing has been stored yet

  // State that is not stored. A reset initialises most of it.
  bool powered_ = false;
  bool init_asserted_ = false;
  bool init_mode_ = false;
  bool runs_modbus_ = false;
  unsigned address_ = 0;
  unsigned baud_code_ = 0x06;
  bool checksum_ = false;
  bool counts_rising_ = false;
  unsigned outputs_ = 0;
  /// The moments at which timed outputs are switched off.
  std::array<std::optional<Moment>, 16> timers_;
  bool reset_status_ = false;
  unsigned terminals_ = 0;             ///< levels at the inputs; a reset does not change them
  std::array<Time, 16> last_edges_{};  ///< the times of the latest edges at the terminals
  /// The moments at which the running filter times end.
  std::array<std::optional<Moment>, 16> settling_;
  unsigned levels_ = 0;  ///< levels after inversion and filter
  unsigned latch_high_ = 0;
  unsigned latch_low_ = 0;
  std::array<std::uint32_t, 16> counters_{};
  std::array<std::uint32_t, 16> wide_counters_{};
  struct Sample {
    std::string first_second;
    bool read = false;
  };
  std::optional<Sample> sample_;
  Framing framing_ = Framing::Nothing;
  std::string frame_;
  bool spoiled_ = false;  ///< in a frame: one of its bytes had a line error
  /// The line tallies (extensions.md), except those of overruns and of lost frames. In Modbus, the first five
  /// are counters of function 08.
  struct Counts {
    unsigned bus_messages = 0;
    unsigned crc_errors = 0;
    unsigned exceptions = 0;
    unsigned server_messages = 0;
    unsigned no_response = 0;
    unsigned bad_bytes = 0;
  } counts_;
  std::optional<Moment> expiry_;
  Time came_up_{0};                 ///< the earliest possible time of the last reset
  unsigned reset_reason_ = 0;       ///< register 0x0301
  unsigned timeouts_ = 0;           ///< register 0x0304
  unsigned stores_ = 0;             ///< register 0x0305
  bool read_blank_memory_ = false;  ///< the last reset found nothing stored
  Time stored_by_{0};               ///< the time by which the last command without a reply has been stored
  Time timeout_stored_{0};          ///< the time by which the last timeout has been stored

  // State of the latest request.
  Time now_{0};
  bool restarted_ = false;
  unsigned timers_started_ = 0;  ///< bit n is channel n
  const char* left_open_ = nullptr;
};

}  // namespace ex9000::reference
