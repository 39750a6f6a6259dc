// A Modbus module without a board and without a simulated line, for tests that send many frames.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "firmware/line/crc16.hpp"
#include "firmware/module.hpp"
#include "tests/support/clock_at.hpp"
#include "tests/support/instant_memory.hpp"

namespace ex9000 {

class CoreBench {
 public:
  using FrameBytes = std::vector<std::uint8_t>;

  /// Starts the module with an erased memory, and returns when the module listens.
  explicit CoreBench(std::string_view model) : module_(*find_model(model)) {
    module_.start(0, now_);
    while (!module_.listening()) {
      memory_.serve(module_, now_);
      pass(milliseconds(1));
    }
    module_.listen(LineTiming::at(module_.baud(), module_.format()));
  }

  Module& module() { return module_; }
  [[nodiscard]] Time now() const { return now_; }
  /// Advances the clock by `time`, then runs one pass of the main loop. This pass also processes the events
  /// that became due during `time`.
  void pass(Duration time) {
    now_ = now_ + time;
    module_.step(false, now_);
  }

  void byte(std::uint8_t value, ByteStatus status = ByteStatus::Good) {
    constexpr Duration kCharacter{1042};  // at 9600 baud
    now_ = now_ + kCharacter;
    module_.on_byte(value, status, ClockAt{now_});
  }
  /// Lets a silence of at least 50 ms pass, which ends every frame.
  void silence() {
    now_ = now_ + milliseconds(50);
    for (Duration wait = end_wait(); !(wait == Duration()); wait = end_wait()) {
      now_ = now_ + wait;
    }
  }
  /// Passes all bytes of a frame and the silence after it to the module. The main loop does not process the
  /// frame yet.
  void hear(const FrameBytes& bytes) {
    for (const std::uint8_t each : bytes) {
      byte(each);
    }
    silence();
  }
  /// Runs the main loop until the module has processed the received frame and has stored the settings that
  /// the frame changes. Returns the reply with its CRC; empty if there is no reply.
  FrameBytes answer() {
    module_.step(false, now_);
    memory_.serve(module_, now_);
    const Bytes reply = module_.take_reply(now_);
    FrameBytes answer(reply.begin(), reply.end());
    if (!answer.empty()) {
      module_.on_reply_sent(now_);
      module_.step(false, now_);
    }
    return answer;
  }
  /// Appends the CRC to `frame` and passes the result to the module. Returns the reply as `answer` does.
  FrameBytes ask(const FrameBytes& frame) {
    hear(with_crc(frame));
    return answer();
  }
  static FrameBytes with_crc(FrameBytes frame) {
    const Crc16 crc = crc16({frame.data(), frame.size()});
    frame.push_back(crc.low_byte());
    frame.push_back(crc.high_byte());
    return frame;
  }

 private:
  Duration end_wait() {
    const Duration wait = module_.on_silence(now_);
    return module_.arbitrates() ? module_.on_window(now_, false) : wait;
  }

  InstantMemory memory_;
  Module module_;
  Time now_;
};

}  // namespace ex9000
