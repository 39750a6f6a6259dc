#include "firmware/line/receiver.hpp"

#include "firmware/model/built.hpp"

namespace ex9000 {

void Receiver::listen(const Listening& how) {
  protocol_ = how.protocol;
  dcon_.use_checksum(how.checksum);
  rtu_.use(how.timing);
}

Duration Receiver::on_byte(std::uint8_t byte, ByteStatus status, Time now) {
  if (spoken_.load() != spoken_seen_) {
    cut_off(now);
  }
  if (ascii()) {
    const Verdict verdict = dcon_.byte(queue_, byte, status, own_address(), now);
    if (verdict == Verdict::Open) {
      return {};
    }
    note(verdict, now);
    return verdict == Verdict::Accepted ? timing().dcon_turn_around : Duration();
  }
  const Verdict verdict = rtu_.byte(queue_, byte, status, own_address(), now);
  if (verdict != Verdict::Open) {
    note(verdict, now);
  }
  return timing().rtu_silence;
}

Duration Receiver::on_silence() {
  if (ascii()) {
    return {};
  }
  if (spoken_.load() != spoken_seen_) {
    cut_off(rtu_.silent_since());
  }
  const Verdict verdict = rtu_.silence(queue_, own_address());
  if (verdict == Verdict::Open) {
    return rtu_.wants_more_silence() ? timing().rtu_grace : Duration();
  }
  note(verdict, rtu_.silent_since());
  return {};
}

void Receiver::cut_off(Time now) {
  spoken_seen_ = spoken_.load();
  if (ascii()) {
    dcon_.forget();
    return;
  }
  const Verdict verdict = rtu_.cut_off(queue_, own_address());
  if (verdict != Verdict::Open) {
    note(verdict, now);
  }
}

void Receiver::note(Verdict verdict, Time now) {
  if constexpr (kBuiltModbus) {
    tally(verdict);
  }
  if (verdict == Verdict::HostOk) {
    host_ok_time_.store_in_interrupt(now.microseconds());
    host_oks_.store_in_interrupt(host_oks_.load() + 1U);
  }
}

void Receiver::tally(Verdict verdict) {
  const bool right = verdict <= Verdict::NoRoom;
  (right ? tallies_.bus_messages : tallies_.bus_errors).count_in_interrupt();
  if (verdict <= Verdict::HostOk) {
    tallies_.server_messages.count_in_interrupt();
    if (verdict == Verdict::HostOk) {
      tallies_.no_responses.count_in_interrupt();
    }
  } else if (verdict == Verdict::NoRoom || verdict == Verdict::Overrun) {
    tallies_.overruns.count_in_interrupt();
  }
}

}  // namespace ex9000
