#include "firmware/line/receiver.hpp"

namespace ex9000 {

void Receiver::listen(const Listening& how) {
  protocol_ = how.protocol;
  dcon_.use_checksum(how.checksum);
  rtu_.use(how.timing);
}

void Receiver::answer_to(std::uint8_t address) {
  dcon_.answer_to(address);
  rtu_.answer_to(address);
}

Duration Receiver::on_silence(Time now) {
  if (!modbus() || rtu_.arbitration().active()) {
    return {};
  }
  note(rtu_.silence(queue_, now), now);
  return rtu_.next_wait();
}

void Receiver::on_own_driver_off(Time now) {
  if (modbus()) {
    rtu_.arbitration().on_sent();
    // The module's own reply ends the frame, even before its silence is over.
    note(rtu_.cut_off(queue_, now), now);
  } else {
    dcon_.forget();
  }
}

bool Receiver::restarts_host_watchdog(Verdict verdict) const {
  const bool is_request = verdict == Verdict::Accepted || verdict == Verdict::NoRoom;
  const bool to_all = modbus() ? rtu_.last_was_broadcast() : dcon_.last_was_broadcast();
  return verdict == Verdict::HostOk || (is_request && !to_all && restarts_by_requests_.load());
}

void Receiver::count(Verdict verdict, Time over) {
  tallies_.count_in_interrupt(verdict);
  if (restarts_host_watchdog(verdict)) {
    host_oks_.add_in_interrupt(over);
  }
}

}  // namespace ex9000
