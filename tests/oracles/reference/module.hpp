// A second implementation of a module, written from the specification alone and as simply as possible. It
// processes all bytes of a request in one call, has no interrupts, and stores settings immediately. It shares
// no code with the firmware, except the names of the line formats. If this module and the firmware agree on a
// random world, two independent readings of the specification agree. Section, E and D numbers refer to
// wire.md.
#pragma once

#include <algorithm>
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
#include "tests/oracles/reference/update.hpp"

namespace ex9000::reference {

using Bytes = std::vector<std::uint8_t>;
/// Time since an arbitrary origin, which must be the same for all calls of one module.
using Time = std::chrono::nanoseconds;
/// wire.md 2: the longest time from power-on or reset until the module listens.
inline constexpr std::chrono::milliseconds kComingUp{100};
/// wire.md 6 and extensions.md: what the module does by itself is at most this late.
inline constexpr std::chrono::milliseconds kLate{1};
/// A time that is only known to lie between two.
struct Moment {
  Time earliest;
  Time latest;
};
inline bool operator==(const Moment& a, const Moment& b) {
  return a.earliest == b.earliest && a.latest == b.latest;
}
inline Moment hull(const Moment& a, const Moment& b) {
  return {std::min(a.earliest, b.earliest), std::max(a.latest, b.latest)};
}
/// Makes `mine` cover `its`. Returns whether that changes it.
inline bool widen(Moment& mine, const Moment& its) {
  const Moment before = mine;
  mine = hull(mine, its);
  return !(mine == before);
}
inline Moment operator+(const Moment& moment, Time time) {
  return {moment.earliest + time, moment.latest + time};
}
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
  unsigned serial_number = 0;          ///< 0: that of the board
  unsigned updates_allowed = 1;        ///< register 0x0254
};

inline bool operator==(const Stored& a, const Stored& b) {
  const auto members = [](const Stored& s) {
    return std::tie(s.address, s.baud_code, s.format, s.modbus, s.name, s.power_on, s.safe, s.enabled,
                    s.timeout, s.timed_out, s.restarted_by_requests, s.delay, s.filters, s.inversion,
                    s.serial_number, s.updates_allowed);
  };
  return members(a) == members(b);
}

/// The module's reaction to a request.
struct Answer {
  Bytes reply;            ///< empty: no reply
  std::string refusal;    ///< why the request is refused, for people
  bool sets = false;      ///< gives settings values, which they may already have
  bool stores = false;    ///< settings change; storing takes up to 200 ms
  bool programs = false;  ///< a slot changes before the reply
  bool is_block = false;  ///< by a block, which may wait for an erase
};

/// A module. Its supply is off at first.
class Module {
 public:
  explicit Module(const ModelRow& row);

  // --- events ---

  /// Sets the stored values. Call this only while the supply is off, because some of the values would take
  /// effect immediately.
  void store(const Stored& stored) {
    stored_ = stored;
    blank_memory_ = false;
  }
  /// 0: the board has none.
  void set_serial_number_of_board(unsigned number) { serial_number_of_board_ = number; }
  /// Switches the supply. `when`: the reset.
  void power(bool on, Moment when);
  /// Resets in a row by the watchdog or a fault, each within 60 s of the one before. Before `reset`.
  void set_crashes(unsigned crashes) { crashes_ = crashes; }
  [[nodiscard]] unsigned crashes() const { return crashes_; }
  /// Resets the module. Has no effect while the supply is off. `reason`: the value of register 0x0301.
  void reset(Moment when, unsigned reason = 4);
  /// The outputs are driven: the host watchdog of this reset runs since then at the latest.
  void started(Time by);
  /// The module begins to listen. `init`: whether in INIT mode, which INIT* decides.
  void select_mode(bool init);
  void set_init(bool asserted) { init_asserted_ = asserted; }
  void set_input(unsigned channel, bool level, Time now);
  void pulse_input(unsigned channel, std::uint32_t count, Time now);
  /// Executes a frame: all bytes between two silences in Modbus; from its delimiter to its CR in ASCII.
  /// `bad`: which of its bytes have a line error. `when`: the execution. `overtaken`: if the host watchdog
  /// has expired since the module has judged the frame, the `lasting_outputs` before that (wire.md D6 and
  /// D17).
  Answer on_frame(const Bytes& bytes, const std::vector<bool>& bad, Moment when,
                  std::optional<unsigned> overtaken = {});
  /// The settings could not be read (wire.md 2): the module uses the factory settings.
  void use_factory_settings();
  /// A store was interrupted or has failed: register 0x0306 may read anything that it can.
  void doubt_memory() { doubts_memory_ = true; }
  [[nodiscard]] bool may_have_spoilt_blank_memory() const { return doubts_memory_ && blank_memory_; }
  /// Stores the settings in force although no setting has changed (wire.md 8).
  void store_again() {
    stores_ += 1;
    blank_memory_ = false;
  }
  /// The same, but the store of the settings fails (wire.md 8).
  Answer on_frame_without_store(const Bytes& bytes, const std::vector<bool>& bad, Moment when,
                                std::optional<unsigned> overtaken);
  /// The frame is complete: counts it. Returns whether it concerns this module, so that it must be executed.
  /// `when`: its end.
  bool on_receipt(const Bytes& bytes, const std::vector<bool>& bad, Moment when);
  /// The last complete frame was for the address that the module did not have yet.
  void miss_frame();
  /// The last complete frame is lost, because no buffer is free.
  void lose_frame();
  /// Bytes that are no frame.
  void count_remains() { counts_.crc_errors += 1; }
  /// A byte with a line error.
  void on_bad_byte() { counts_.bad_bytes += 1; }
  /// Where the specification permits several replies, the next frame takes these choices, in this order; each
  /// is less than the number in `alternatives` at its place. Missing choices are 0.
  void choose(std::vector<unsigned> choices) {
    choices_ = std::move(choices);
    alternatives_.clear();
  }
  /// The number of alternatives of each choice of the last frame.
  [[nodiscard]] const std::vector<unsigned>& alternatives() const { return alternatives_; }
  /// The host watchdog expires; the timeout is stored later.
  void expire();
  /// A frame does not restart the host watchdog after all.
  void keep_expiry(Moment expiry) { expiry_ = expiry; }
  void timeout_stored();
  void end_timed_output(unsigned channel);
  void settle_input(unsigned channel);
  /// What the slots hold, and what is known about it.
  void set_update(const Update& update) { update_ = update; }
  /// A reply has left.
  void replied() { update_.answered = update_.state == UpdateState::Unconfirmed; }
  /// 60 s without a reset are over, or further 60 s.
  void end_update_period();
  /// The same, but the flash does not take the confirmation.
  void prolong_update_period() { update_.periods += 1; }
  /// The flash has failed.
  void fail_update() {
    update_.state = UpdateState::Failed;
    update_.activates = false;
  }
  /// The module activates the complete image by itself.
  void activate_by_itself() {
    update_.state = UpdateState::Pending;
    update_.activates = false;
  }

  /// Returns whether the modules differ at most in their moments.
  [[nodiscard]] bool is_like(const Module& other) const;
  /// Makes the moments cover those of a module that is like this one. Returns whether that changes any.
  bool widen(const Module& other);

  // --- visible state ---

  [[nodiscard]] bool powered() const { return powered_; }
  [[nodiscard]] unsigned outputs() const { return outputs_; }
  /// What `~AA5V` stores: a timed output is off (extensions.md).
  [[nodiscard]] unsigned lasting_outputs() const { return outputs_ & ~timed_outputs(); }
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
  /// 0: none.
  [[nodiscard]] unsigned serial_number() const {
    return stored_.serial_number != 0 ? stored_.serial_number : serial_number_of_board_;
  }
  static bool is_by_number(const Bytes& frame);
  [[nodiscard]] bool init_asserted() const { return init_asserted_; }
  /// Returns whether a reset would start or end INIT mode, or would change the protocol, address, baud rate,
  /// line format or checksum in force.
  [[nodiscard]] bool waits_for_reset() const;
  [[nodiscard]] const Stored& stored() const { return stored_; }
  [[nodiscard]] unsigned reset_reason() const { return reset_reason_; }
  [[nodiscard]] const ModelRow& row() const { return *row_; }
  [[nodiscard]] const Update& update() const { return update_; }
  /// Of the model and the board, as an update begins with it.
  [[nodiscard]] std::string signature() const;

  /// When the module changes by itself. A moment is longer than an instant if its cause, for example a
  /// command or a reset, is not visible from outside.
  [[nodiscard]] const std::optional<Moment>& expiry() const { return expiry_; }
  [[nodiscard]] const Moment& came_up() const { return came_up_; }
  [[nodiscard]] const std::optional<Moment>& end_of_output(unsigned channel) const {
    return timers_[channel];
  }
  [[nodiscard]] const std::optional<Moment>& settling(unsigned channel) const { return settling_[channel]; }
  /// Returns the lowest channel number of the inputs whose filter times are running, if there is one.
  [[nodiscard]] std::optional<unsigned> settling_input() const;

 private:
  /// The line tallies (extensions.md), except those of overruns. In Modbus, the first five are counters of
  /// function 08.
  struct Counts {
    unsigned bus_messages = 0;
    unsigned crc_errors = 0;
    unsigned exceptions = 0;
    unsigned server_messages = 0;
    unsigned no_response = 0;
    unsigned bad_bytes = 0;
    unsigned lost = 0;

    friend bool operator==(const Counts& a, const Counts& b) {
      const auto members = [](const Counts& c) {
        return std::tie(c.bus_messages, c.crc_errors, c.exceptions, c.server_messages, c.no_response,
                        c.bad_bytes, c.lost);
      };
      return members(a) == members(b);
    }
  };

  /// A command gives settings values.
  Stored& set() {
    sets_ = true;
    return stored_;
  }
  /// Returns the next of the choices.
  unsigned choice(unsigned alternatives) {
    alternatives_.push_back(alternatives);
    return alternatives_.size() <= choices_.size() ? choices_[alternatives_.size() - 1] : 0;
  }

  // wire.md 2 and 12
  void come_up(Moment when);
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
  void clear_timeout_status() { set().timed_out = stored_.timed_out && overtaken_.has_value(); }
  /// wire.md 6: output commands are refused while the timeout status is set.
  [[nodiscard]] bool refuses_outputs() const { return stored_.timed_out && !overtaken_; }
  [[nodiscard]] unsigned all_outputs() const { return (1U << row_->outputs) - 1; }
  void drive(unsigned channels, unsigned values);
  void set_timed_output(unsigned channel, unsigned time);
  unsigned time_left(unsigned channel);
  [[nodiscard]] unsigned timed_outputs() const;

  // wire.md 3 and 4, dcon.cpp
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
  void count(unsigned Counts::*what) { received_.*what += 1; }
  [[nodiscard]] unsigned tally(unsigned index) const;
  unsigned extension_value(unsigned address);
  unsigned extension_word(unsigned address);
  void set_extension(unsigned address, unsigned value);
  std::string delay_command(const std::string& body);
  std::string extension_command(const std::string& body);

  // extensions.md, update.cpp
  [[nodiscard]] std::string model_text() const;
  [[nodiscard]] std::string version_text() const;
  [[nodiscard]] unsigned next_offset() const;
  void begin_update(const Bytes& data);
  [[nodiscard]] std::string block_refusal(unsigned offset, const Bytes& bytes, bool crc_is_right) const;
  void receive_block(const Bytes& data);
  void judge_update_action(unsigned value) const;
  void act_on_update(unsigned value);
  void confirm_update();

  const ModelRow* row_;
  unsigned crashes_ = 0;
  unsigned serial_number_of_board_ = 0;
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

    friend bool operator==(const Sample& a, const Sample& b) {
      return a.first_second == b.first_second && a.read == b.read;
    }
  };
  std::optional<Sample> sample_;
  Counts counts_;
  std::optional<Moment> expiry_;
  Moment came_up_{};                ///< the last reset
  unsigned reset_reason_ = 0;       ///< register 0x0301
  unsigned timeouts_ = 0;           ///< register 0x0304
  unsigned stores_ = 0;             ///< register 0x0305
  bool read_blank_memory_ = false;  ///< the last reset found nothing stored
  bool doubts_memory_ = false;
  Update update_;

  // State of the latest frame.
  Moment now_{};
  Counts received_;  ///< what its receipt counts
  bool sets_ = false;
  bool programs_ = false;
  bool is_block_ = false;
  bool own_ = false;  ///< it is for this module alone
  std::string refusal_;
  std::optional<unsigned> overtaken_;
  std::vector<unsigned> choices_;
  std::vector<unsigned> alternatives_;
};

}  // namespace ex9000::reference
