// Assembles DCON (ASCII) frames from received bytes; runs in the receive interrupt.
#pragma once

#include <cstdint>

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

  /// Interrupt. `own_address` is the one this module answers to at this moment. An accepted frame holds the
  /// characters from the delimiter on, without CHK and CR.
  Verdict byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status, std::uint8_t own_address, Time now);

  /// Interrupt. Forgets an open frame.
  void forget() { state_ = State::Hunting; }

 private:
  enum class State : std::uint8_t {
    Hunting,   ///< between frames: what is neither delimiter nor lead is noise
    InFrame,   ///< every character is content
    Spoiled,   ///< a frame that is lost already; `loss_` says why
    Skipping,  ///< another module is answering: whatever it says, up to its CR
  };

  void open_or_skip(FrameQueue& queue, std::uint8_t byte, ByteStatus status);
  Verdict judge(FrameQueue& queue, std::uint8_t own_address, Time now);

  State state_ = State::Hunting;
  Verdict loss_ = Verdict::Open;
  bool checksum_ = false;
  std::uint8_t size_ = 0;
  std::uint8_t sum_ = 0;
};

}  // namespace ex9000
