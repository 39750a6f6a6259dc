// A witness receives the same bytes as a module. It checks whether the module does what these bytes require.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/bytes.hpp"
#include "firmware/model/line_format.hpp"
#include "firmware/model/model.hpp"
#include "tests/oracles/judges/dcon_demand.hpp"
#include "tests/oracles/judges/dcon_judge.hpp"
#include "tests/oracles/judges/dcon_reply.hpp"
#include "tests/oracles/judges/demand.hpp"
#include "tests/oracles/judges/finding.hpp"
#include "tests/oracles/judges/line_times.hpp"
#include "tests/oracles/judges/requests.hpp"
#include "tests/oracles/judges/rtu_demand.hpp"
#include "tests/oracles/judges/rtu_judge.hpp"
#include "tests/oracles/judges/rtu_reply.hpp"
#include "tests/oracles/judges/time.hpp"
#include "tests/oracles/judges/value_changes.hpp"

namespace ex9000::judges {

/// How a module listens immediately after a reset.
struct Listening {
  bool modbus = false;
  std::uint8_t address = 0;
  std::uint32_t baud = 0;
  LineFormat format = LineFormat::k8N1;
  bool checksum = false;
  bool init_mode = false;
  bool strict_gaps = false;
  Microseconds doubt = 0;  ///< see RtuJudge
  bool delays = false;     ///< a response delay is set
};

/// Reports a violated claim if
///  - no received request explains a reply, or a reply begins too early or too late, or a reply does not
///    have the form that its request requires;
///  - the values (outputs, their running timers, power-on value, safe value, timeout and enable of the host
///    watchdog, timeout status) change, but received commands, an expiry of the host watchdog and ended
///    timers of outputs do not explain exactly this change;
///  - when the reply that accepts a command begins, the values do not match the effects of this command;
///  - after an idle module has received a broadcast that drives outputs and stores nothing, the values do not
///    match the effects of this broadcast;
///  - an output command is accepted although its form is wrong or the timeout status blocks it;
///  - a command is refused although it has changed a value;
///  - a valid output command is refused although the timeout status is not set and no store can have failed;
///  - a valid output command is refused with a reply other than `!` and exception 04;
///  - any other command is refused with `!`, or with exception 04 although it stores nothing;
///  - an idle module does not reply in time to a request for it that is not a host OK;
///  - the host watchdog expires too early;
///  - the timer of an output ends too early;
///  - in ASCII, the address changes while no received request waits for its reply;
///  - the outputs do not have the safe value while the timeout status is set;
///  - the module drives an output that the model does not have.
///
/// This class does not check that the host watchdog or a timer expires in time, that a reply waits for the
/// response delay, that requests restart the host watchdog if register 0x0251 is 1, or that the module
/// refuses a write of a timed output by `~AAX` if the form of the command is wrong.
///
/// `now` must not decrease from one call to the next. Exception: the `now` of `reply_begins` may be earlier
/// than the `now` of the call before it.
class Witness {
 public:
  /// Receives the claim that is violated.
  using ReportViolation = void (*)(const char* claim);
  /// Numbers of received frames.
  struct Counts {
    std::uint64_t requests = 0;
    std::uint64_t silent = 0;    ///< broadcasts and host OKs, which get no reply
    std::uint64_t host_oks = 0;  ///< the frames of `silent` that are host OKs
    std::uint64_t foreign = 0;
    std::uint64_t storing = 0;  ///< the frames of `requests` and `silent` that may store something
  };

  Witness(const Model& model, ReportViolation report_violation)
      : model_(model), report_violation_(report_violation) {}

  /// Call this when the module has started with `values`. `reset`: the time of the reset. If the reset
  /// interrupted a command, this class does not check what the command has stored
  /// (tests/boards/power_cuts/power_cuts_test.cpp does that). This class checks the later changes of the
  /// values.
  void comes_up(const Listening& listening, const Values& values, Microseconds reset) {
    rtu_.reset();
    dcon_.reset();
    times_ = LineTimes::at(listening.baud, listening.format);
    if (listening.modbus) {
      rtu_.emplace(listening.address, times_, listening.strict_gaps, listening.doubt);
    } else {
      dcon_.emplace(listening.address, listening.checksum);
    }
    listening_ = listening;
    changes_.module_reset(values, reset);
    pending_.clear();
    now_ = free_ = busy_ = reset;
    held_ = sending_ = broadcast_ = false;
    delays_ = listening.delays;
  }

  [[nodiscard]] bool hears_modbus() const { return rtu_.has_value(); }
  [[nodiscard]] bool wants_checksum() const { return dcon_ && dcon_->checksum(); }
  [[nodiscard]] Microseconds character() const { return times_.character; }
  /// Returns T3.5. In ASCII the function returns a value too, but T3.5 has no meaning there.
  [[nodiscard]] Microseconds silence() const { return times_.t35; }
  /// In Modbus, see RtuJudge::beyond_doubt. In ASCII, returns `end`.
  [[nodiscard]] Microseconds beyond_doubt(Microseconds end) const {
    return rtu_ ? rtu_->beyond_doubt(end) : end;
  }
  [[nodiscard]] const Counts& counts() const { return counts_; }

  /// Call this when the test stops the module's main loop, and when the main loop continues.
  void is_held(bool held, Microseconds now) {
    pass(now);
    held_ = held;
    if (!held) {
      free_ = std::max(free_, now);
    }
  }

  /// Call this when no byte has arrived until `now`.
  void pass(Microseconds now) {
    now_ = now;
    note_silence();
    look();
  }

  /// Call this at the end of the first stop bit of a byte that arrived while the module's driver was off,
  /// before the module executes a request that this byte completes. `good`: the byte has no line error.
  /// `address`: the address at which the module replies.
  void hears(std::uint8_t byte, bool good, std::uint8_t address, Microseconds now) {
    pass(now);
    if (rtu_) {
      rtu_->byte(byte, good, now);
    } else {
      may_have_taken(address);
      note(dcon_->byte(byte, good, now));
    }
    drop_stale();
    if (pending_.size() != 0 || held_) {
      busy_ = now;
    }
  }

  /// Checks the present values of the module. Call this after a turn of the main loop, or when an output has
  /// changed.
  void follow(const Values& values, Microseconds now) {
    if (values == changes_.values()) {
      return;
    }
    now_ = now;
    note_silence();
    mark_fresh();
    const char* const objection = changes_.objection_to_change(values, pending_, now_);
    if (objection != nullptr) {
      report_violation_(objection);
    }
    if ((changes_.values().timed & ~values.timed) != 0) {
      look_before_a_timer_ends();
    }
    changes_.change(values, pending_);
    if (values.timed_out && values.outputs != values.safe) {
      report_violation_("outputs are the safe value while the timeout status is set");
    }
    if ((values.outputs & ~model_.output_mask()) != 0) {
      report_violation_("only outputs that the model has are driven");
    }
  }

  /// Call this after a turn of the main loop. `address`: the present address of the module.
  void follow_address(std::uint8_t address) {
    if (dcon_ && pending_.size() == 0 && address != dcon_->own_address()) {
      report_violation_("only a command changes the address");
    }
  }

  /// Call this for each reply, after `follow` and before `reply_ends`. `reply`: the complete reply. `now`:
  /// the time at which the module's driver was switched on.
  void reply_begins(Bytes reply, Microseconds now) {
    now_ = now;
    sending_ = true;
    note_silence();
    rtu_ ? take_rtu_reply(reply) : take_dcon_reply(reply);
  }

  /// Call this when the driver has been switched off.
  void reply_ends(Microseconds now) {
    now_ = now;
    sending_ = false;
    free_ = now + distance();
    if (rtu_) {
      note(rtu_->spoken());
    } else {
      dcon_->spoken();
    }
  }

 private:
  void note(const Finding& finding) {
    switch (finding.kind) {
      case Finding::Kind::Nothing:
        return;
      case Finding::Kind::Foreign:
        ++counts_.foreign;
        return;
      case Finding::Kind::HostOk:
        ++counts_.silent;
        ++counts_.host_oks;
        if (!held_) {  // a held module stores only the times of the first and the last host OK
          changes_.watchdog().restarts_at_the_earliest(finding.last);
        }
        return;
      case Finding::Kind::Request:
        ++counts_.requests;
        break;
      case Finding::Kind::Broadcast:
        ++counts_.silent;
        break;
    }
    if (pending_.size() == Requests::kMost) {
      pending_.drop_oldest(1);
      broadcast_ = false;
    }
    Request& latest = pending_.append(finding);
    latest.over = rtu_ ? std::min(finding.last + times_.silence, now_) : finding.last + times_.turn_around;
    latest.demand =
        rtu_ ? rtu_demand(finding.frame, model_.outputs) : dcon_demand(finding.frame, model_.outputs);
    latest.alone = finding.first > busy_ && !finding.doubtful;
    changes_.note(latest);
    delays_ = delays_ || (rtu_ ? may_set_delay_by_rtu(finding.frame) : may_set_delay_by_dcon(finding.frame));
    counts_.storing += latest.demand.stores_something ? 1U : 0U;
    broadcast_ =
        latest.alone && latest.broadcast && latest.demand.drives() && !latest.demand.stores_something;
  }
  void note_silence() {
    if (rtu_) {
      Finding finding = rtu_->pass(now_);
      finding.last += finding.kind == Finding::Kind::HostOk ? times_.silence : 0;  // wire.md D11
      note(finding);
    }
  }

  /// Returns the least time from the report of the last byte of a request to a reply.
  [[nodiscard]] Microseconds distance() const { return rtu_ ? times_.silence : times_.turn_around; }

  static constexpr Microseconds kLongestDelay = 30 * kMillisecond;  // wire.md 12

  /// Returns the latest time at which the module executes `request` and begins the reply, if the module is
  /// idle from `free` on (wire.md 3, 7 and 12).
  [[nodiscard]] Microseconds latest_of(const Request& request, Microseconds free) const {
    constexpr Microseconds kPlain = 20 * kMillisecond;
    constexpr Microseconds kStoring = 200 * kMillisecond;
    const Microseconds over =
        request.last + times_.rest + std::max(rtu_ ? times_.t35 : 0, delays_ ? kLongestDelay : 0);
    return std::max(over, free) + (request.demand.stores_something ? kStoring : kPlain);
  }

  /// Marks the requests that may still be executed.
  void mark_fresh() {
    Microseconds free = free_;
    for (std::size_t i = 0; i < pending_.size(); ++i) {
      Request& each = pending_[i];
      const Microseconds latest = latest_of(each, free);
      each.fresh = now_ <= latest;
      free = each.is_silent_store() ? latest : free;
    }
  }

  /// Drops requests that can no longer be executed. Reports a violation if an idle module has not replied to
  /// such a request.
  void drop_stale() {
    while (pending_.size() != 0 && !held_ && !sending_) {
      const Request& oldest = pending_[0];
      const Microseconds latest = latest_of(oldest, free_);
      if (now_ <= latest) {
        return;
      }
      if (!oldest.broadcast && oldest.alone) {
        report_violation_("an idle module replies in time");
      }
      if (oldest.is_silent_store()) {
        free_ = latest;
      }
      pending_.drop_oldest(1);
    }
  }

  /// Finds the request to which a reply belongs, and drops this request and all requests before it. Returns
  /// the form of the reply. Reports a violation and returns ReplyForm::Wrong if there is no such request.
  /// `form_of`: returns the form that the reply has for a request. `refuses_outputs`: see
  /// objection_to_refusal.
  template <class FormOf>
  ReplyForm answered(bool refuses_outputs, FormOf form_of) {
    mark_fresh();
    const char* objection = "a module replies only to frames for it";
    for (std::size_t i = 0; i < pending_.size(); ++i) {
      const Request& request = pending_[i];
      if (request.broadcast || !request.fresh) {
        continue;
      }
      const ReplyForm form = form_of(request.frame());
      objection = form == ReplyForm::Wrong     ? "a reply has the form that its request demands"
                  : form == ReplyForm::Refusal ? objection_to_refusal(request, refuses_outputs)
                                               : objection_to_answer(request);
      if (objection != nullptr) {
        continue;  // the module may have lost this request
      }
      if (now_ < request.last + distance()) {
        report_violation_("a reply does not begin too early");
      }
      if (form == ReplyForm::Answer && request.demand.restarts) {
        changes_.watchdog().restarts_at_the_earliest(request.over);
      }
      answered_ = request;
      pending_.drop_oldest(i + 1);
      return form;
    }
    report_violation_(objection);
    return ReplyForm::Wrong;
  }

  void take_rtu_reply(Bytes reply) {
    if (reply.size < 5 || reply.size > 256) {
      return report_violation_("a Modbus reply has 5 to 256 bytes");
    }
    if (crc16(reply.data, reply.size) != 0) {
      return report_violation_("a Modbus reply carries its CRC");
    }
    constexpr std::uint8_t kFailure = 0x04;
    answered(reply[2] == kFailure,
             [=](Bytes request) { return rtu_reply_form(request, reply.first(reply.size - 2)); });
  }

  void take_dcon_reply(Bytes reply) {
    if (reply.size < 2 || reply[reply.size - 1] != '\r') {
      return report_violation_("a DCON reply ends with CR");
    }
    std::size_t size = reply.size - 1;
    for (const std::uint8_t c : reply.first(size)) {
      if (c < 0x20 || c > 0x7E) {
        return report_violation_("a DCON reply is printable");
      }
    }
    if (dcon_->checksum()) {
      if (size <= 2 || !are_digits_of(reply.data + size - 2, dcon_sum(reply.data, size - 2))) {
        return report_violation_("a DCON reply carries its checksum");
      }
      size -= 2;
    }
    const DconRules rules{dcon_->own_address(), listening_.init_mode, model_.has_inputs(),
                          model_.has_outputs()};
    const ReplyForm form = answered(size == 1 && reply[0] == '!', [&](Bytes request) {
      return dcon_reply_form(request, reply.first(size), rules);
    });
    if (form == ReplyForm::Answer && answered_.bytes[0] == '%' && !rules.init_mode) {
      dcon_->answer_to(new_address(answered_.frame()));
    }
    dcon_->may_answer_to(std::nullopt);
  }

  /// Allows frames for `address` if a pending `%` sets it. Between the end of the store and the reply to `%`,
  /// the new address is already in force.
  void may_have_taken(std::uint8_t address) {
    for (std::size_t i = 0; i < pending_.size(); ++i) {
      const Request& each = pending_[i];
      if (each.bytes[0] == '%' && each.size == 11 && new_address(each.frame()) == address) {
        dcon_->may_answer_to(address);
      }
    }
  }

  /// Returns why the module cannot have refused the request, or null if the module can have refused it.
  /// `refuses_outputs`: the reply is `!` (the timeout status blocks an output command) or exception 04 (the
  /// same, or a store has failed).
  [[nodiscard]] const char* objection_to_refusal(const Request& request, bool refuses_outputs) const {
    const Demand& demand = request.demand;
    if (request.done) {
      return "a refused request changes nothing";
    }
    const bool may_fail = rtu_ && demand.stores_something;
    if (demand.drives()) {
      return refuses_outputs && (changes_.values().timed_out || may_fail)
                 ? nullptr
                 : "an output command of the right form is refused only while the timeout status is set, or "
                   "if its "
                   "store has failed";
    }
    return refuses_outputs && !may_fail ? "only an output command is refused because of the timeout status"
                                        : nullptr;
  }

  /// Returns why the module cannot have executed the request, or null if the module can have executed it.
  [[nodiscard]] const char* objection_to_answer(const Request& request) const {
    const Demand& demand = request.demand;
    const bool since = changes_.has_expired_since(request);
    const bool output_command = rtu_ ? judges::is_rtu_output_command(request.frame())
                                     : judges::is_dcon_output_command(request.frame());
    if (output_command && !demand.drives()) {
      return "an output command of a wrong form is refused";
    }
    if (demand.drives() && changes_.values().timed_out && !since) {
      return "an output command is refused while the timeout status is set";
    }
    return changes_.meet(request, since) ? nullptr : "an accepted command has exactly the required effects";
  }

  /// Checks that an idle module has executed the latest broadcast, if this must still be checked.
  void look() {
    if (broadcast_ && !held_) {
      broadcast_ = false;
      if (!changes_.values().timed_out && !changes_.meet(pending_[0], false)) {
        report_violation_("an idle module executes a broadcast");
      }
    }
  }

  /// Checks the latest broadcast before the values change at the end of a timer, because this change can undo
  /// the effect of the broadcast. Does not check a broadcast that may take effect in the same turn.
  void look_before_a_timer_ends() {
    if (broadcast_ && now_ > latest_of(pending_[0], free_)) {
      look();
    }
    broadcast_ = false;
  }

  const Model& model_;
  ReportViolation report_violation_;
  Listening listening_;
  std::optional<RtuJudge> rtu_;
  std::optional<DconJudge> dcon_;
  Counts counts_;
  Microseconds now_ = 0;
  LineTimes times_;
  Requests pending_;
  Request answered_;
  ValueChanges changes_;
  bool held_ = false;
  bool delays_ = false;  ///< a response delay may be in force
  bool sending_ = false;
  /// An idle module has received a broadcast that drives outputs and stores nothing, and the effect of this
  /// broadcast has not been checked yet.
  bool broadcast_ = false;
  Microseconds free_ = 0;  ///< from this time on, a request waits only for earlier requests
  Microseconds busy_ = 0;  ///< time of the last byte that arrived while the module was busy
};

}  // namespace ex9000::judges
