// Assembles received bytes into DCON (ASCII) frames, in interrupts.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/hex.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/line/verdict.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Characters before CR; longer frames are dropped.
constexpr std::uint8_t kLongestDconFrame = 32;

/// Delimiter, address, body, [CHK], CR - wire.md section 3. No timeout between characters, so that a person
/// can type commands. Interrupts call all functions from `byte` on.
class DconAssembler {
 public:
  void use_checksum(bool on) { checksum_ = on; }
  /// For frames that end after this call. For the main loop, also while bytes are received.
  void answer_to(std::uint8_t address) { own_digits_.store_in_main_loop(hex_digits(address)); }

  static constexpr std::uint8_t kEnd = '\r';

  void byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status);
  /// For kEnd: the verdict on the frame that it ends, or Open. An accepted frame has neither CHK nor CR.
  Verdict end(FrameQueue& queue, ByteStatus status, Time now);

  /// Whether the last frame with a correct check was a broadcast. Valid only if it was not Foreign.
  [[nodiscard]] bool last_was_broadcast() const { return broadcast_; }
  /// Drops an incomplete frame, and no longer skips another module's reply.
  void forget() { state_ = State::Hunting; }

 private:
  enum class State : std::uint8_t {
    Hunting,   ///< between frames; ignores all characters except delimiters and `!`, `>`, `?` of a reply
    InFrame,   ///< in a frame; a delimiter does not begin a new frame
    Spoiled,   ///< in a frame that is already lost; `loss_` is the reason
    Skipping,  ///< in another module's reply; all characters up to its CR are ignored
  };

  void add(std::uint8_t* text, std::uint8_t byte);
  void open_or_skip(FrameQueue& queue, std::uint8_t byte);
  void spoil(ByteStatus status);
  Verdict judge(FrameQueue& queue, Time now);

  WrittenByMainLoop<std::uint32_t> own_digits_;
  State state_ = State::Hunting;
  Verdict loss_ = Verdict::Open;
  bool checksum_ = false;
  bool broadcast_ = false;  ///< the last frame with a correct check and an address was a broadcast or Foreign
  std::uint8_t size_ = 0;
  std::uint8_t sum_ = 0;  ///< sum of all characters except the last two
};

}  // namespace ex9000
