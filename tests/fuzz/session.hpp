// A module between one judge and another: what it hears is judged here once more, and whatever it does is
// held against that.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "firmware/model/baud.hpp"
#include "firmware/model/model.hpp"
#include "tests/fuzz/dcon_judge.hpp"
#include "tests/fuzz/dcon_reply.hpp"
#include "tests/fuzz/finding.hpp"
#include "tests/fuzz/lean_module.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/fuzz/rtu_judge.hpp"
#include "tests/fuzz/rtu_reply.hpp"
#include "tests/judges/dcon_demand.hpp"
#include "tests/judges/demand.hpp"
#include "tests/judges/rtu_demand.hpp"

namespace ex9000::fuzz {

using judges::Demand;
using judges::Values;

/// Aborts where
///  - a reply begins that no frame has asked for, or too early or too late, or that is not of the form that
///    the request demands;
///  - outputs, power-on and safe value, the host watchdog's timeout and enable, or the timeout status change
///    to anything but what a command demands that was heard, to the bit, or a timeout of the host watchdog;
///    or at a reset outputs are not what is stored;
///  - a command is answered, or heard by a module with nothing else to do, and these are not what it demands;
///  - a command is refused, and one of them has changed all the same; or an output command is refused that is
///    right;
///  - a frame for a module with nothing else to do gets no answer;
///  - the host watchdog expires too early;
///  - outputs are not the safe value while the timeout status is set, or a model drives one that it lacks.
///
/// Of the module's own words it believes what is in force from a reset on, and which settings it has come up
/// with: what of a command that the reset cut short is stored is a matter of power cuts
/// (registers/power_cuts_test.cpp). All that values become from then on follows from frames.
class Session final : public Onlooker {
 public:
  Session(const Model& model, bool strict_gaps)
      : model_(model),
        strict_gaps_(strict_gaps),
        module_(model, *this, strict_gaps ? LineTiming::strictly_at : LineTiming::at) {}
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  LeanModule& module() { return module_; }
  Surroundings& around() { return module_.around(); }
  /// From the last reset to the next.
  [[nodiscard]] bool speaks_modbus() const { return rtu_.has_value(); }
  [[nodiscard]] const InForce& in_force() const { return state().in_force; }
  [[nodiscard]] Microseconds character() const { return character_; }
  /// T3.5; in DCON too, where it means nothing.
  [[nodiscard]] Microseconds silence() const { return silence_; }

  void reset() {
    rtu_.reset();
    dcon_.reset();
    pending_count_ = 0;
    held_until_ = kNever;
    booting_ = true;
    free_ = alive_ = busy_ = module_.now();
    expired_ = 0;
    broadcast_ = false;
    outputs_ = 0;
    module_.reset();
    booting_ = false;
    const std::uint32_t baud = baud_rate(in_force().baud_code);
    if (in_force().protocol == Protocol::ModbusRtu) {
      rtu_.emplace(in_force().address, baud, strict_gaps_);
    } else {
      dcon_.emplace(in_force().address, baud, in_force().checksum);
    }
    character_ = 10'000'000ULL / baud;
    silence_ = baud <= 19200 ? 38'500'000ULL / baud : 1750;
    values_ = values();
    require(outputs_ == (values_.timed_out ? values_.safe : values_.power_on),
            "outputs come up with the power-on value, or the safe value behind a timeout");
  }

  void wait(Microseconds time) { advance_to(module_.now() + time); }
  /// The main loop does nothing for so long.
  void hold(Microseconds time) {
    note_silence();
    look();
    held_until_ = module_.now() + time;
    module_.hold(true);
  }
  void toggle_input(unsigned channel) { module_.toggle_input(channel); }
  void tick() { module_.tick(); }

  /// A byte that begins `gap` from now, or a little later.
  void byte(std::uint8_t byte, ByteStatus status, Microseconds gap = 0) {
    Microseconds end = module_.now() + gap + character_;
    if (rtu_) {
      end = rtu_->beyond_doubt(end);
    }
    advance_to(end);
    if (module_.sending()) {
      return;  // the echo's place: nobody hears it
    }
    const bool good = status == ByteStatus::Good;
    if (rtu_) {
      note_silence();
      look();
      rtu_->byte(byte, good, end);
    } else {
      may_have_taken_address();
      note(dcon_->byte(byte, good, end));
    }
    drop_stale();
    if (pending_count_ != 0 || module_.held()) {
      busy_ = end;
    }
    module_.receive(byte, status);
  }

  /// Until the module has been silent for 250 ms.
  void wait_for_quiet() {
    do {
      wait(250 * kMillisecond);
    } while (module_.sending());
  }

  /// A request without its check, put on a quiet line with it, and the reply without its check; empty where
  /// there is none. It lives until the next one.
  Bytes ask(Bytes request) {
    reply_size_ = 0;
    for (const std::uint8_t each : request) {
      byte(each, ByteStatus::Good);
    }
    if (rtu_) {
      const std::uint16_t crc = crc16(request.data, request.size);
      byte(static_cast<std::uint8_t>(crc % 256), ByteStatus::Good);
      byte(static_cast<std::uint8_t>(crc / 256), ByteStatus::Good);
    } else {
      if (dcon_->checksum()) {
        const std::uint8_t sum = dcon_sum(request.data, request.size);
        byte(upper_hex(sum / 16U), ByteStatus::Good);
        byte(upper_hex(sum), ByteStatus::Good);
      }
      byte('\r', ByteStatus::Good);
    }
    wait_for_quiet();
    return {reply_.data(), reply_size_};
  }

  // --- Onlooker ---

  void reply_begins(Bytes reply) override {
    follow();
    note_silence();
    rtu_ ? take_rtu_reply(reply) : take_dcon_reply(reply);
    std::copy(reply.begin(), reply.end(), reply_.begin());
    reply_size_ = reply.size - (rtu_ ? 2 : dcon_->checksum() ? 3 : 1);
  }

  void reply_ends() override {
    free_ = module_.now() + distance();
    if (rtu_) {
      note(rtu_->spoken());
    } else {
      dcon_->spoken();
    }
  }

  void outputs_change(std::uint16_t channels) override {
    require(!booting_ || outputs_ == 0, "outputs come up without a glitch");
    outputs_ = channels;
    if (!booting_) {
      follow();
    }
  }

  void turned() override {
    if (!booting_) {
      follow();
      require(!dcon_ || pending_count_ != 0 || in_force().address == dcon_->own_address(),
              "the address changes by a command only");
    }
  }

 private:
  struct Pending {
    std::array<std::uint8_t, 256> bytes;
    std::size_t size;
    Microseconds last;
    Demand demand;
    bool broadcast;
    bool alone;  ///< the module had nothing else to do
    bool fresh;  ///< see mark_fresh
    bool done;   ///< values have changed, and by no other

    [[nodiscard]] Bytes frame() const { return {bytes.data(), size}; }
  };
  /// The module keeps one and executes one; others may have been lost, which only it knows. As many as may
  /// come in while the main loop is held.
  static constexpr std::size_t kMostPending = 32;

  [[nodiscard]] const State& state() const { return module_.module().state(); }

  void advance_to(Microseconds until) {
    if (held_until_ <= until) {
      module_.advance_to(std::exchange(held_until_, kNever));
      free_ = std::max(free_, module_.now());
      module_.hold(false);
    }
    module_.advance_to(until);
    look();
  }

  void note(const Finding& finding) {
    if (finding.kind == Finding::Kind::Nothing) {
      return;
    }
    if (finding.kind == Finding::Kind::HostOk) {
      if (!module_.held()) {  // of several, the module knows the last one then
        alive_ = std::max(alive_, finding.last);
      }
      return;
    }
    if (pending_count_ == kMostPending) {
      drop_oldest(1);
      broadcast_ = false;
    }
    Pending& latest = pending(pending_count_++);
    std::copy(finding.frame.begin(), finding.frame.end(), latest.bytes.begin());
    latest.size = finding.frame.size;
    latest.last = finding.last;
    latest.demand = rtu_ ? judges::rtu_demand(finding.frame, model_.outputs)
                         : judges::dcon_demand(finding.frame, model_.outputs);
    latest.broadcast = finding.kind == Finding::Kind::Broadcast;
    latest.alone = finding.first > busy_;
    latest.done = false;
    broadcast_ =
        latest.alone && latest.broadcast && latest.demand.drives() && !latest.demand.stores_something;
  }
  void note_silence() {
    if (rtu_) {
      Finding finding = rtu_->pass(module_.now());
      finding.last += finding.kind == Finding::Kind::HostOk ? silence_ : 0;  // D11
      note(finding);
    }
  }
  Pending& pending(std::size_t index) { return pending_[(oldest_ + index) % kMostPending]; }
  void drop_oldest(std::size_t count) {
    oldest_ = (oldest_ + count) % kMostPending;
    pending_count_ -= count;
  }

  /// From a request's last byte, or from the module's own, to a reply.
  [[nodiscard]] Microseconds distance() const { return rtu_ ? silence_ : character_; }

  /// wire.md 3 and 7: until when a request is acted upon, where the module was free from then on.
  [[nodiscard]] Microseconds latest_of(const Pending& request, Microseconds free) const {
    constexpr Microseconds kPlain = 20 * kMillisecond;
    constexpr Microseconds kStoring = 200 * kMillisecond;
    const Microseconds over = request.last + (rtu_ ? silence_ : 0);
    return std::max(over, free) + (request.demand.stores_something ? kStoring : kPlain);
  }
  /// What has no answer may be under way for all of its time.
  static bool is_silent_store(const Pending& request) {
    return request.broadcast && request.demand.stores_something;
  }

  /// Which requests may still be acted upon.
  void mark_fresh() {
    Microseconds free = free_;
    for (std::size_t i = 0; i < pending_count_; ++i) {
      Pending& each = pending(i);
      const Microseconds latest = latest_of(each, free);
      each.fresh = module_.now() <= latest;
      free = is_silent_store(each) ? latest : free;
    }
  }

  /// Requests that cannot be acted upon any more.
  void drop_stale() {
    while (pending_count_ != 0 && !module_.held() && !module_.sending()) {
      const Pending& oldest = pending(0);
      const Microseconds latest = latest_of(oldest, free_);
      if (module_.now() <= latest) {
        return;
      }
      require(oldest.broadcast || !oldest.alone, "a module with nothing else to do answers in time");
      if (is_silent_store(oldest)) {
        free_ = latest;
      }
      drop_oldest(1);
    }
  }

  /// The request that `form_of` finds the reply to be one to, and that has come to that; it and all before it
  /// are done with.
  template <class FormOf>
  ReplyForm answered(bool refuses_outputs, FormOf form_of) {
    mark_fresh();
    const char* objection = "only a frame for the module is answered";
    for (std::size_t i = 0; i < pending_count_; ++i) {
      const Pending& request = pending(i);
      if (request.broadcast || !request.fresh) {
        continue;
      }
      const ReplyForm form = form_of(request.frame());
      objection = form == ReplyForm::Wrong     ? "a reply has the form that its request demands"
                  : form == ReplyForm::Refusal ? objection_to_refusal(request, refuses_outputs)
                                               : objection_to_answer(request);
      if (objection != nullptr) {
        continue;  // it may have been lost
      }
      require(module_.now() >= request.last + distance(), "a reply keeps its distance");
      if (form == ReplyForm::Answer && request.demand.restarts) {
        alive_ = std::max(alive_, request.last + distance());
      }
      answered_ = request;
      drop_oldest(i + 1);
      return form;
    }
    require(false, objection);
    return ReplyForm::Wrong;
  }

  void take_rtu_reply(Bytes reply) {
    require(reply.size >= 5 && reply.size <= 256, "a Modbus reply has 5 to 256 bytes");
    require(crc16(reply.data, reply.size) == 0, "a Modbus reply carries its CRC");
    constexpr std::uint8_t kFailure = 0x04;
    answered(reply[2] == kFailure,
             [=](Bytes request) { return rtu_reply_form(request, reply.first(reply.size - 2)); });
  }

  void take_dcon_reply(Bytes reply) {
    require(reply.size >= 2 && reply[reply.size - 1] == '\r', "a DCON reply ends with CR");
    std::size_t size = reply.size - 1;
    for (const std::uint8_t c : reply.first(size)) {
      require(c >= 0x20 && c <= 0x7E, "a DCON reply is printable");
    }
    if (dcon_->checksum()) {
      require(size > 2, "a DCON reply carries its checksum");
      size -= 2;
      require(are_digits_of(reply.data + size, dcon_sum(reply.data, size)),
              "a DCON reply carries the right checksum");
    }
    const DconRules rules{dcon_->own_address(), in_force().init_mode, model_.has_inputs(),
                          model_.has_outputs()};
    const ReplyForm form = answered(size == 1 && reply[0] == '!', [&](Bytes request) {
      return dcon_reply_form(request, reply.first(size), rules);
    });
    if (form == ReplyForm::Answer && answered_.bytes[0] == '%' && !rules.init_mode) {
      dcon_->answer_to(new_address(answered_.frame()));
    }
    dcon_->may_answer_to(std::nullopt);
  }

  /// The second and third of what is a hex digit each; others make no request that is answered.
  static std::uint8_t new_address(Bytes request) {
    const auto value = [](unsigned digit) { return digit > '9' ? digit - 'A' + 10 : digit - '0'; };
    return static_cast<std::uint8_t>(value(request[3]) * 16 + value(request[4]));
  }

  /// Between the end of the store and the reply to `%`, the new address is in force already.
  void may_have_taken_address() {
    for (std::size_t i = 0; i < pending_count_; ++i) {
      const Pending& each = pending(i);
      if (each.bytes[0] == '%' && each.size == 11 && new_address(each.frame()) == in_force().address) {
        dcon_->may_answer_to(in_force().address);
      }
    }
  }

  /// Why a request cannot have been refused, or null. `refuses_outputs`: as outputs are blocked, or where
  /// Modbus could not store.
  [[nodiscard]] const char* objection_to_refusal(const Pending& request, bool refuses_outputs) const {
    const Demand& demand = request.demand;
    if (request.done) {
      return "a refused request changes nothing";
    }
    const bool may_fail = rtu_ && demand.stores_something;
    if (demand.drives()) {
      return refuses_outputs && (values_.timed_out || may_fail)
                 ? nullptr
                 : "an output command of the right form is refused behind a timeout only";
    }
    return refuses_outputs && !may_fail ? "only an output command is refused for a timeout" : nullptr;
  }

  /// Why a request cannot have been carried out, or null.
  [[nodiscard]] const char* objection_to_answer(const Pending& request) const {
    const Demand& demand = request.demand;
    const bool since = has_expired_since(request);
    const bool output_command = rtu_ ? judges::is_rtu_output_command(request.frame())
                                     : judges::is_dcon_output_command(request.frame());
    if (output_command && !demand.drives()) {
      return "an output command of a wrong form is refused";
    }
    if (demand.drives() && values_.timed_out && !since) {
      return "an output command is refused while the timeout status is set";
    }
    return demand.is_met_by(values_, outputs_before_, since) ? nullptr
                                                             : "what is answered is done, to the bit";
  }

  [[nodiscard]] bool has_expired_since(const Pending& request) const { return expired_ >= request.last; }

  [[nodiscard]] Values values() const {
    const Settings& settings = state().settings;
    return {outputs_,
            settings.power_on_value,
            settings.safe_value,
            settings.watchdog_timeout,
            settings.watchdog_enabled,
            settings.timeout_status};
  }

  /// The main loop has turned, or is about to tell why.
  void follow() {
    const Values now = values();
    if (now == values_) {
      return;
    }
    note_silence();
    mark_fresh();
    if (!one_leads_to(now)) {
      const bool expires = now.timed_out && !values_.timed_out;
      require(!expires || may_expire(values_), "the host watchdog never expires too early");
      require(some_lead(values_, now, 0, kMostInATurn),
              "values change by what a command demands, a timeout or a reset only");
    }
    values_ = now;
    require(!now.timed_out || now.outputs == now.safe,
            "outputs are the safe value while the timeout status is set");
    require((now.outputs & ~model_.output_mask()) == 0, "only outputs that the model has are driven");
  }

  /// One broadcast that was being stored, another one behind it, and what the silence behind that has ended.
  static constexpr unsigned kMostInATurn = 3;

  [[nodiscard]] bool leads(const Pending& request, const Values& from, const Values& to) const {
    const Demand& demand = request.demand;
    return request.fresh && !request.done && demand.changes_values() &&
           (demand.made_of(from) == to || (from.timed_out && has_expired_since(request) &&
                                           demand.made_behind_a_timeout(from, outputs_before_) == to));
  }

  /// Whether one command has made `to` of the values, as nearly always.
  bool one_leads_to(const Values& to) {
    Pending* only = nullptr;
    unsigned count = 0;
    for (std::size_t i = 0; i < pending_count_; ++i) {
      if (leads(pending(i), values_, to)) {
        only = &pending(i);
        ++count;
      }
    }
    if (count == 1) {
      only->done = true;
      if (only->demand.restarts) {
        alive_ = module_.now();
      }
    }
    return count != 0;
  }

  [[nodiscard]] bool may_expire(const Values& values) const {
    constexpr Microseconds kUnit = 100 * kMillisecond;
    return values.enabled && module_.now() - alive_ >= values.timeout * kUnit;
  }

  /// Whether a timeout, or some commands from the one at `next` on, or both, have made `to` of `from`.
  bool some_lead(const Values& from, const Values& to, std::size_t next, unsigned most) {
    if (from == to) {
      return true;
    }
    if (may_expire(from)) {
      const auto outputs = std::exchange(outputs_before_, from.outputs);
      const auto expired = std::exchange(expired_, module_.now());
      if (some_lead(from.expired(), to, next, most)) {
        return true;
      }
      outputs_before_ = outputs;
      expired_ = expired;
    }
    for (std::size_t i = next; most != 0 && i < pending_count_; ++i) {
      const Pending& each = pending(i);
      if (leads(each, from, to)) {
        return true;
      }
      if (each.fresh && !each.done && each.demand.changes_values()) {
        if (some_lead(each.demand.made_of(from), to, i + 1, most - 1)) {
          return true;
        }
        if (from.timed_out && has_expired_since(each) &&
            some_lead(each.demand.made_behind_a_timeout(from, outputs_before_), to, i + 1, most - 1)) {
          return true;
        }
      }
    }
    return false;
  }

  /// What is to be seen when time has passed.
  void look() {
    if (broadcast_ && !module_.held()) {
      broadcast_ = false;
      require(values_.timed_out || pending(0).demand.is_met_by(values_, outputs_before_, false),
              "a broadcast to a module with nothing else to do is carried out");
    }
  }

  const Model& model_;
  bool strict_gaps_;
  LeanModule module_;
  std::optional<RtuJudge> rtu_;
  std::optional<DconJudge> dcon_;
  Microseconds character_ = 0;
  Microseconds silence_ = 0;
  std::array<Pending, kMostPending> pending_;
  std::size_t oldest_ = 0;
  std::size_t pending_count_ = 0;
  Pending answered_;
  std::array<std::uint8_t, 256> reply_{};
  std::size_t reply_size_ = 0;
  std::uint16_t outputs_ = 0;
  Values values_;                     ///< as commands and timeouts have made them
  std::uint16_t outputs_before_ = 0;  ///< before the latest timeout
  Microseconds expired_ = 0;          ///< when that was; 0: not since the last reset
  bool booting_ = false;
  bool broadcast_ = false;  ///< one has come in, alone, and nobody has looked for what it has done
  Microseconds alive_ = 0;  ///< no restart of the host watchdog was earlier than this
  Microseconds free_ = 0;   ///< from then on nothing but requests can keep the module from the next one
  Microseconds busy_ = 0;   ///< the last byte that found it so came then
  Microseconds held_until_ = kNever;
};

}  // namespace ex9000::fuzz
