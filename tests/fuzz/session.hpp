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

namespace ex9000::fuzz {

/// Aborts where
///  - a reply begins that no frame has asked for, or too early or too late, or that is not of the form that
///  the request
///    demands;
///  - an output changes but by a command to drive outputs, a timeout of the host watchdog, or a reset;
///  - a command is refused and an output has changed all the same;
///  - the host watchdog expires too early;
///  - outputs are not the safe value while the timeout status is set, or a model drives one that it lacks.
///
/// Of the module's own words it believes what is in force from a reset on, and the present settings.
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
    reply_ended_ = alive_ = module_.now();
    timed_out_ = heard_host_ok_ = false;
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
    timed_out_ = state().settings.timeout_status;
    timeout_ = state().settings.watchdog_timeout;
    look();
  }

  void wait(Microseconds time) { advance_to(module_.now() + time); }
  /// The main loop does nothing for so long.
  void hold(Microseconds time) {
    note_silence();
    look();
    held_until_ = module_.now() + time;
    module_.hold(true);
  }
  void toggle_input(unsigned channel) {
    module_.toggle_input(channel);
    look();
  }
  void tick() {
    module_.tick();
    look();
  }

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
      note(rtu_->pass(end));
      rtu_->byte(byte, good, end);
    } else {
      may_have_taken_address();
      note(dcon_->byte(byte, good, end));
    }
    module_.receive(byte, status);
    look();
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
    note_silence();
    const ReplyForm form = rtu_ ? take_rtu_reply(reply) : take_dcon_reply(reply);
    std::copy(reply.begin(), reply.end(), reply_.begin());
    reply_size_ = reply.size - (rtu_ ? 2 : dcon_->checksum() ? 3 : 1);
    require(!(form == ReplyForm::Refusal && answered_.drove), "a refused request drives nothing");
  }

  void reply_ends() override {
    reply_ended_ = module_.now();
    if (rtu_) {
      note(rtu_->spoken());
    } else {
      dcon_->spoken();
    }
  }

  void outputs_change(std::uint16_t channels) override {
    outputs_ = channels;
    if (booting_) {
      return;
    }
    note_silence();
    if (has_timed_out()) {
      return;
    }
    Pending* driver = nullptr;
    unsigned drivers = 0;
    for (std::size_t i = 0; i < pending_count_; ++i) {
      Pending& each = pending(i);
      if (!each.drove && is_fresh(each) && may_drive(each.frame())) {
        driver = &each;
        ++drivers;
      }
    }
    require(drivers != 0, "an output changes by a command, a timeout or a reset only");
    driver->drove = drivers == 1;
  }

 private:
  struct Pending {
    std::array<std::uint8_t, 256> bytes;
    std::size_t size;
    Microseconds last;
    bool broadcast;
    bool drove;  ///< an output has changed, and by no other

    [[nodiscard]] Bytes frame() const { return {bytes.data(), size}; }
  };
  /// The module keeps one and executes one; others may have been lost, which only it knows. As many as may
  /// come in while the main loop is held.
  static constexpr std::size_t kMostPending = 32;

  [[nodiscard]] const State& state() const { return module_.module().state(); }

  void advance_to(Microseconds until) {
    if (held_until_ <= until) {
      module_.advance_to(std::exchange(held_until_, kNever));
      module_.hold(false);
      released_ = module_.now();
    }
    module_.advance_to(until);
    look();
  }

  void note(const Finding& finding) {
    if (finding.kind == Finding::Kind::HostOk && !module_.held()) {
      alive_ = std::max(alive_, finding.last);
      heard_host_ok_ = true;
    }
    if (finding.kind == Finding::Kind::Nothing || finding.kind == Finding::Kind::HostOk) {
      return;
    }
    if (pending_count_ == kMostPending) {
      drop_oldest(1);
    }
    Pending& latest = pending(pending_count_++);
    std::copy(finding.frame.begin(), finding.frame.end(), latest.bytes.begin());
    latest.size = finding.frame.size;
    latest.last = finding.last;
    latest.broadcast = finding.kind == Finding::Kind::Broadcast;
    latest.drove = false;
  }
  void note_silence() {
    if (rtu_) {
      note(rtu_->pass(module_.now()));
    }
  }
  Pending& pending(std::size_t index) { return pending_[(oldest_ + index) % kMostPending]; }
  void drop_oldest(std::size_t count) {
    oldest_ = (oldest_ + count) % kMostPending;
    pending_count_ -= count;
  }

  /// Whether it may still be acted upon: within 200 ms of the end of its silence, or of what was done before
  /// it.
  [[nodiscard]] bool is_fresh(const Pending& request) const {
    constexpr Microseconds kLatest = 200 * kMillisecond;
    const Microseconds over = request.last + (rtu_ ? silence_ : character_);
    return module_.now() <= std::max({over, reply_ended_, released_}) + kLatest;
  }
  [[nodiscard]] bool may_drive(Bytes request) const {
    return rtu_ ? rtu_may_drive(request) : dcon_may_drive(request, state().settings.timeout_status);
  }

  /// The request that `form_of` finds the reply to be one to; it and all before it are done with.
  template <class FormOf>
  ReplyForm answered(FormOf form_of) {
    bool asked = false;
    for (std::size_t i = 0; i < pending_count_; ++i) {
      const Pending& request = pending(i);
      if (request.broadcast || !is_fresh(request)) {
        continue;
      }
      asked = true;
      const ReplyForm form = form_of(request.frame());
      if (form == ReplyForm::Wrong) {
        continue;
      }
      require(module_.now() >= request.last + (rtu_ ? silence_ : character_), "a reply keeps its distance");
      answered_ = request;
      drop_oldest(i + 1);
      return form;
    }
    require(asked, "only a frame for the module is answered");
    require(false, "a reply has the form that its request demands");
    return ReplyForm::Wrong;
  }

  ReplyForm take_rtu_reply(Bytes reply) {
    require(reply.size >= 5 && reply.size <= 256, "a Modbus reply has 5 to 256 bytes");
    require(crc16(reply.data, reply.size) == 0, "a Modbus reply carries its CRC");
    return answered([=](Bytes request) { return rtu_reply_form(request, reply.first(reply.size - 2)); });
  }

  ReplyForm take_dcon_reply(Bytes reply) {
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
    const DconRules rules{dcon_->own_address(), in_force().init_mode, state().settings.timeout_status};
    const ReplyForm form =
        answered([&](Bytes request) { return dcon_reply_form(request, reply.first(size), rules); });
    if (form == ReplyForm::Answer && answered_.bytes[0] == '%' && !rules.init_mode) {
      dcon_->answer_to(new_address(answered_.frame()));
    }
    dcon_->may_answer_to(std::nullopt);
    return form;
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

  /// True where the host watchdog has expired since it was asked last.
  bool has_timed_out() {
    const Settings& settings = state().settings;
    const unsigned timeout =
        std::min(settings.watchdog_timeout, std::exchange(timeout_, settings.watchdog_timeout));
    const bool was = std::exchange(timed_out_, settings.timeout_status);
    if (was || !timed_out_) {
      return false;
    }
    constexpr Microseconds kUnit = 100 * kMillisecond;
    require(module_.now() - alive_ >= timeout * kUnit, "the host watchdog never expires too early");
    require(state().outputs == settings.safe_value, "a timeout puts the outputs to the safe value");
    return true;
  }

  /// What holds at all times.
  void look() {
    if (!module_.held() && std::exchange(heard_host_ok_, false)) {
      module_.tick();  // a host OK is no news; it is heeded with the next tick
    }
    if (std::exchange(turns_, module_.turns()) != module_.turns()) {
      has_timed_out();
      require(!timed_out_ || outputs_ == state().settings.safe_value,
              "outputs are the safe value while the timeout status is set");
      require((outputs_ & ~model_.output_mask()) == 0, "only outputs that the model has are driven");
      require(!dcon_ || pending_count_ != 0 || in_force().address == dcon_->own_address(),
              "the address changes by a command only");
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
  bool booting_ = false;
  bool timed_out_ = false;
  bool heard_host_ok_ = false;
  std::uint8_t timeout_ = 0;  ///< as it was when that was looked at
  std::uint64_t turns_ = 0;
  Microseconds alive_ = 0;  ///< the last host OK, or the last reset
  Microseconds reply_ended_ = 0;
  Microseconds held_until_ = kNever;
  Microseconds released_ = 0;
};

}  // namespace ex9000::fuzz
