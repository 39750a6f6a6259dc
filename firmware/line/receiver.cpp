#include "firmware/line/receiver.hpp"

#include "firmware/model/built.hpp"

namespace ex9000 {

void Receiver::listen(const Listening& how) {
  protocol_ = how.protocol;
  dcon_.use_checksum(how.checksum);
  rtu_.use(how.timing);
}

Duration Receiver::on_byte(std::uint8_t byte, ByteStatus status, Time now) {
  cut_off_if_spoken(now);
  const std::uint8_t own_address = address_.load();
  if (ascii()) {
    const Verdict verdict = dcon_.byte(queue_, byte, status, own_address, now);
    note(verdict, now);
    return verdict == Verdict::Accepted ? timing().dcon_turn_around : Duration();
  }
  note(rtu_.byte(queue_, byte, status, own_address, now), now);
  return timing().rtu_silence;
}

Duration Receiver::on_silence() {
  if (ascii()) {
    return {};
  }
  const Time now = rtu_.silent_since();
  cut_off_if_spoken(now);
  note(rtu_.silence(queue_, address_.load()), now);
  return rtu_.wants_more_silence() ? timing().rtu_grace : Duration();
}

void Receiver::cut_off_if_spoken(Time now) {
  const std::uint8_t spoken = spoken_.load();
  if (spoken == spoken_seen_) {
    return;
  }
  spoken_seen_ = spoken;
  if (ascii()) {
    dcon_.forget();
  } else {
    note(rtu_.cut_off(queue_, address_.load()), now);
  }
}

void Receiver::note(Verdict verdict, Time now) {
  if (verdict == Verdict::Open) {
    return;
  }
  if constexpr (kBuiltModbus) {
    tally(verdict);
  }
  if (verdict == Verdict::HostOk) {
    host_ok_time_.store_in_interrupt(now.microseconds());
    host_oks_.store_in_interrupt(static_cast<std::uint8_t>(host_oks_.load() + 1U));
  }
}

void Receiver::tally(Verdict verdict) {
  switch (verdict) {
    case Verdict::Accepted:
      tallies_.bus_messages.count_in_interrupt();
      tallies_.server_messages.count_in_interrupt();
      break;
    case Verdict::HostOk:
      tallies_.bus_messages.count_in_interrupt();
      tallies_.server_messages.count_in_interrupt();
      tallies_.no_responses.count_in_interrupt();
      break;
    case Verdict::Foreign:
      tallies_.bus_messages.count_in_interrupt();
      break;
    case Verdict::NoRoom:
      tallies_.bus_messages.count_in_interrupt();
      tallies_.overruns.count_in_interrupt();
      break;
    case Verdict::Overrun:
      tallies_.bus_errors.count_in_interrupt();
      tallies_.overruns.count_in_interrupt();
      break;
    case Verdict::BadCheck:
    case Verdict::TooShort:
    case Verdict::TooLong:
    case Verdict::LineError:
      tallies_.bus_errors.count_in_interrupt();
      break;
    case Verdict::Open:
      break;
  }
}

}  // namespace ex9000
