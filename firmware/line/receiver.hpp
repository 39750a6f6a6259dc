// The interrupt side of the line: bytes in, complete frames for this module out.
#pragma once

#include <cstdint>

#include "firmware/line/crossing.hpp"
#include "firmware/line/dcon_assembler.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/line/line_tallies.hpp"
#include "firmware/line/rtu_assembler.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/line/verdict.hpp"
#include "firmware/model/built.hpp"
#include "firmware/settings/settings.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// How to listen, from one reset to the next.
struct Listening {
  Protocol protocol = Protocol::Ascii;
  bool checksum = false;
  LineTiming timing{};
};

class Receiver {
 public:
  /// Main loop, before bytes are passed on.
  void listen(const Listening& how);

  // --- interrupts, which must not interrupt each other ---

  /// A byte was received; `now` is the end of its stop bit, or earlier by what the timing allows for. Returns
  /// the time after which `on_silence` must be called, counted from now and restarted by every byte; zero:
  /// the timer is left as it is. After a DCON frame it is the turn-around.
  Duration on_byte(std::uint8_t byte, ByteStatus status, Time now);

  /// That time has passed. Returns as `on_byte` does.
  Duration on_silence();

  /// This module's own driver was on until `now`, and no byte was passed on meanwhile: a frame that is open
  /// and not whole is forgotten (wire.md D9).
  void on_spoken(Time now);

  // --- main loop ---

  /// The address to answer to, after `listen`; takes effect with the next frame that ends.
  void answer_to(std::uint8_t address);
  /// As given to `listen`.
  [[nodiscard]] const LineTiming& timing() const { return rtu_.timing(); }
  FrameQueue& queue() { return queue_; }
  [[nodiscard]] const FrameQueue& queue() const { return queue_; }
  constexpr LineTallies& tallies() { return tallies_; }
  [[nodiscard]] constexpr const LineTallies& tallies() const { return tallies_; }
  /// Interrupts too. How many host OKs were received; wraps.
  [[nodiscard]] std::uint32_t host_oks() const { return host_oks_.load(); }
  /// When the latest of them was over: its CR, or the silence after it.
  [[nodiscard]] Time host_ok_time() const { return Time(host_ok_time_.load()); }

 private:
  [[nodiscard]] bool modbus() const { return kBuiltModbus && protocol_ == Protocol::ModbusRtu; }
  void note(Verdict verdict, Time over);

  DconAssembler dcon_;
  RtuAssembler rtu_;
  Protocol protocol_ = Protocol::Ascii;
  LineTallies tallies_;
  WrittenByInterrupt<std::uint32_t> host_oks_;
  WrittenByInterrupt<std::uint32_t> host_ok_time_;
  FrameQueue queue_;
};

}  // namespace ex9000
