#include "firmware/line/receiver.hpp"

#include "firmware/model/built.hpp"

namespace ex9000 {

void Receiver::listen(const Listening& how) {
  protocol_ = how.protocol;
  dcon_.use_checksum(how.checksum);
  rtu_.use(how.timing);
}

void Receiver::answer_to(std::uint8_t address) {
  if (ascii()) {
    dcon_.answer_to(address);
  } else {
    rtu_.answer_to(address);
  }
}

/// A silence has ended a frame. Function 08 tells of Modbus only, and which protocol it is stays until a
/// reset.
[[gnu::always_inline]] inline void Receiver::note(Verdict verdict) {
  tallies_.count_in_interrupt(verdict);
  if (verdict == Verdict::HostOk) {
    host_ok(rtu_.silent_since());
  }
}

Duration Receiver::on_byte(std::uint8_t byte, ByteStatus status, Time now) {
  if (ascii()) {
    const Verdict verdict = dcon_.byte(queue_, byte, status, now);
    if (verdict == Verdict::HostOk) {
      host_ok(now);
    }
    return verdict == Verdict::Accepted ? timing().dcon_turn_around : Duration();
  }
  const Verdict verdict = rtu_.byte(queue_, byte, status, now);
  if (verdict != Verdict::Open) {
    // As `note`, but of a silence that nobody has told.
    tallies_.count_in_interrupt(verdict);
    if (verdict == Verdict::HostOk) {
      host_ok(now);
    }
  }
  return timing().rtu_silence;
}

Duration Receiver::on_silence() {
  if (ascii()) {
    return {};
  }
  const Verdict verdict = rtu_.conclude(queue_);
  if (verdict == Verdict::Open) {
    return lapse();
  }
  note(verdict);
  return {};
}

Duration Receiver::lapse() {
  const Verdict verdict = rtu_.lapse();
  if (verdict != Verdict::Open) {
    tallies_.count_in_interrupt(verdict);
  }
  return rtu_.wants_more_silence() ? timing().rtu_grace : Duration();
}

void Receiver::on_spoken() {
  if (ascii()) {
    dcon_.forget();
    return;
  }
  const Verdict verdict = rtu_.cut_off(queue_);
  if (verdict != Verdict::Open) {
    note(verdict);
  }
}

void Receiver::host_ok(Time now) {
  host_ok_time_.store_in_interrupt(now.microseconds());
  host_oks_.store_in_interrupt(host_oks_.load() + 1U);
}

}  // namespace ex9000
