// Assembles received bytes into frames for this module or for all modules, in interrupts.
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/crossing.hpp"
#include "firmware/line/arbitration.hpp"
#include "firmware/line/dcon_assembler.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/line/host_oks.hpp"
#include "firmware/line/line_tallies.hpp"
#include "firmware/line/rtu_assembler.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/line/verdict.hpp"
#include "firmware/model/built.hpp"
#include "firmware/settings/settings.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Does not change between two resets.
struct Listening {
  Protocol protocol = Protocol::Ascii;
  bool checksum = false;
  LineTiming timing{};
};

class Receiver {
 public:
  /// From the main loop, before the first `on_byte`.
  void listen(const Listening& how);

  // --- interrupts, which must not interrupt each other ---

  /// `clock.now_in_interrupt()`: the present time; only a CR in DCON needs it. LineTiming takes into account
  /// the part of the stop bits that is left when the UART reports a byte. Restart the silence timer with the
  /// returned time and call `on_silence` when it has passed; leave the timer alone if it is 0. In Modbus it
  /// is 0 only during an arbitration; in DCON it is the turn-around time after the CR of an accepted frame,
  /// else 0.
  template <class Clock>
  Duration on_byte(std::uint8_t byte, ByteStatus status, const Clock& clock);

  /// When the time from `on_byte` or `on_silence` has passed. Returns the next such time; 0: none. Then, if
  /// `arbitration().active()`, call its `on_time` too, and use that time instead.
  Duration on_silence(Time now);

  /// When the module's own driver is off again; no `on_byte` while it is on. Drops an incomplete frame,
  /// except an RTU frame that lacks only its silence (wire.md D9).
  void on_own_driver_off(Time now);

  // --- main loop ---

  /// For frames that end after this call. After `listen`.
  void answer_to(std::uint8_t address);
  void answer_to_number(std::uint32_t serial_number) { rtu_.answer_to_number(serial_number); }
  /// Whether each request (wire.md D16) with the module's own address and a correct check restarts the host
  /// watchdog like a host OK. For frames that end after this call.
  void restart_by_requests(bool on) { restarts_by_requests_.store_in_main_loop(on); }
  [[nodiscard]] const LineTiming& timing() const { return rtu_.timing(); }
  Arbitration& arbitration() { return rtu_.arbitration(); }
  [[nodiscard]] const Arbitration& arbitration() const { return rtu_.arbitration(); }
  FrameQueue& queue() { return queue_; }
  [[nodiscard]] const FrameQueue& queue() const { return queue_; }
  constexpr LineTallies& tallies() { return tallies_; }
  [[nodiscard]] constexpr const LineTallies& tallies() const { return tallies_; }
  /// Also of requests that count like a host OK.
  HostOks& host_oks() { return host_oks_; }
  [[nodiscard]] const HostOks& host_oks() const { return host_oks_; }

 private:
  // not covered: kBuiltModbus is a constant
  [[nodiscard]] bool modbus() const { return kBuiltModbus && protocol_ == Protocol::ModbusRtu; }
  /// `over`: the time of the restart, if the frame restarts the host watchdog.
  void note(Verdict verdict, Time over) {
    if (verdict != Verdict::Open) {
      count(verdict, over);
    }
  }
  void count(Verdict verdict, Time over);
  [[nodiscard]] bool restarts_host_watchdog(Verdict verdict) const;

  DconAssembler dcon_;
  RtuAssembler rtu_;
  Protocol protocol_ = Protocol::Ascii;
  LineTallies tallies_;
  HostOks host_oks_;
  WrittenByMainLoop<bool> restarts_by_requests_;
  FrameQueue queue_;
};

// Inline, because it runs for each byte on the line, also of other modules.
template <class Clock>
inline Duration Receiver::on_byte(std::uint8_t byte, ByteStatus status, const Clock& clock) {
  if (status != ByteStatus::Good && status != ByteStatus::Overrun) {
    tallies_.count_damaged_byte_in_interrupt();
  }
  if (modbus()) {
    return rtu_.byte(queue_, byte, status);
  }
  if (byte != DconAssembler::kEnd) {
    dcon_.byte(queue_, byte, status);
    return {};
  }
  const Time now = clock.now_in_interrupt();
  const Verdict verdict = dcon_.end(queue_, status, now);
  note(verdict, now);
  return verdict == Verdict::Accepted ? timing().dcon_turn_around : Duration();
}

}  // namespace ex9000
