// Assembles received bytes into frames for this module or for all modules, in interrupts.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"
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

/// The line settings, which do not change between two resets.
struct Listening {
  Protocol protocol = Protocol::Ascii;
  bool checksum = false;
  LineTiming timing{};
};

class Receiver {
 public:
  /// Sets the line settings. The main loop calls this before the first `on_byte`.
  void listen(const Listening& how);

  // --- interrupts, which must not interrupt each other ---

  /// Processes a received byte. `clock.now_in_interrupt()` returns the present time; only a CR in DCON needs
  /// it. LineTiming takes into account the part of the stop bits that is left when the UART reports a byte.
  /// `on_silence` must be called when the returned time has passed: restart the silence timer with this time.
  /// Do not change the timer if the result is 0. In Modbus, the result is never 0. In DCON, it is the
  /// turn-around time if the byte is the CR of an accepted frame, otherwise 0.
  template <class Clock>
  Duration on_byte(std::uint8_t byte, ByteStatus status, const Clock& clock);

  /// Call this when the time that `on_byte` or `on_silence` returned has passed. Returns the time after which
  /// `on_silence` must be called again; 0 if this is not necessary.
  Duration on_silence(Time now);

  /// Call this at `now`, when the module's own driver is off again; `on_byte` must not be called while the
  /// driver is on. Drops an incomplete frame, except an RTU frame that lacks only its silence (wire.md D9).
  void on_own_driver_off(Time now);

  // --- main loop ---

  /// Sets the module's address for all frames that end after this call. Call this after `listen`.
  void answer_to(std::uint8_t address);
  /// Sets whether each request (wire.md D16) with the module's own address and a correct check restarts the
  /// host watchdog like a host OK, for all frames that end after this call.
  void restart_by_requests(bool on) { restarts_by_requests_.store_in_main_loop(on); }
  /// Returns the timing that was passed to `listen`.
  [[nodiscard]] const LineTiming& timing() const { return rtu_.timing(); }
  FrameQueue& queue() { return queue_; }
  [[nodiscard]] const FrameQueue& queue() const { return queue_; }
  constexpr LineTallies& tallies() { return tallies_; }
  [[nodiscard]] constexpr const LineTallies& tallies() const { return tallies_; }
  /// Returns the times of the host OKs, and of the requests that count like a host OK.
  HostOks& host_oks() { return host_oks_; }
  [[nodiscard]] const HostOks& host_oks() const { return host_oks_; }

 private:
  // not covered: kBuiltModbus is a constant
  [[nodiscard]] bool modbus() const { return kBuiltModbus && protocol_ == Protocol::ModbusRtu; }
  /// Counts `verdict`, unless it is Open. If the frame restarts the host watchdog, stores `over` as the time
  /// of the restart.
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

// `on_byte` is inline, because it runs for each byte on the line, including bytes for other modules.
template <class Clock>
inline Duration Receiver::on_byte(std::uint8_t byte, ByteStatus status, const Clock& clock) {
  if (status != ByteStatus::Good && status != ByteStatus::Overrun) {
    tallies_.count_damaged_byte_in_interrupt();
  }
  if (modbus()) {
    rtu_.byte(queue_, byte, status);
    return rtu_.first_wait();
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
