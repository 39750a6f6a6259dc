// Assembles DCON (ASCII) frames from received bytes; runs in the receive interrupt.
#pragma once

#include <cstdint>

#include "firmware/hex.hpp"
#include "firmware/line/crossing.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/line/verdict.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Most characters before CR that are judged.
constexpr std::uint8_t kLongestDconFrame = 32;

/// delimiter, address, body, [CHK], CR - wire.md section 3. There is no inter-character timeout: a person may
/// type.
class DconAssembler {
 public:
  void use_checksum(bool on) { checksum_ = on; }
  /// Main loop, also while bytes come in: the module's address, from the next frame on that ends.
  void answer_to(std::uint8_t address) { own_digits_.store_in_main_loop(hex_digits(address)); }

  /// Interrupt. An accepted frame holds the characters from the delimiter on, without CHK and CR.
  Verdict byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status, Time now);

  /// Interrupt. Forgets an open frame.
  void forget() { state_ = State::Hunting; }

 private:
  enum class State : std::uint8_t {
    Hunting,   ///< between frames: what is neither delimiter nor lead is noise
    InFrame,   ///< every character is content
    Spoiled,   ///< a frame that is lost already; `loss_` says why
    Skipping,  ///< another module is answering: whatever it says, up to its CR
  };

  void add(std::uint8_t* text, std::uint8_t byte);
  void open_or_skip(FrameQueue& queue, std::uint8_t byte);
  Verdict end(FrameQueue& queue, Time now);
  Verdict judge(FrameQueue& queue, Time now);

  WrittenByMainLoop<std::uint32_t> own_digits_;
  State state_ = State::Hunting;
  Verdict loss_ = Verdict::Open;
  bool checksum_ = false;
  std::uint8_t size_ = 0;
  std::uint8_t sum_ = 0;  ///< of all characters but the last two
};

}  // namespace ex9000
