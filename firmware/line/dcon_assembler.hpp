// Assembles received bytes into DCON (ASCII) frames, in interrupts.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/hex.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/line/verdict.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// The largest number of characters before CR; longer frames are dropped.
constexpr std::uint8_t kLongestDconFrame = 32;

/// Frame format: delimiter, address, body, [CHK], CR - wire.md section 3. There is no timeout between
/// characters, so that a person can type commands.
class DconAssembler {
 public:
  void use_checksum(bool on) { checksum_ = on; }
  /// Sets the module's address for all frames that end after this call. For the main loop, which may call
  /// this while bytes are received.
  void answer_to(std::uint8_t address) { own_digits_.store_in_main_loop(hex_digits(address)); }

  static constexpr std::uint8_t kEnd = '\r';

  /// Processes a received byte that is not kEnd. For the receive interrupt, like `end`.
  void byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status);
  /// Processes kEnd. Returns the verdict on the frame that it ends, or Open if it ends no frame. An accepted
  /// frame contains the characters from the delimiter on, without CHK and CR.
  Verdict end(FrameQueue& queue, ByteStatus status, Time now);

  /// Returns whether the last frame with a correct check was a broadcast. Valid only if that frame was not
  /// Foreign. For interrupts.
  [[nodiscard]] bool last_was_broadcast() const { return broadcast_; }
  /// Drops an incomplete frame, and ends the skipping of another module's reply. For interrupts.
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
