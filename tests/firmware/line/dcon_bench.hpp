// A fixture for tests of the DCON assembler: it passes text to the assembler.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "firmware/line/dcon_assembler.hpp"

namespace ex9000 {

inline constexpr std::uint8_t kOwn = 0x01;

class DconAssemblerTest : public testing::Test {
 protected:
  Verdict put(char character, ByteStatus status = ByteStatus::Good) {
    now_ = now_ + Duration(1042);  // one character at 9600 baud
    assembler_.answer_to(own_);
    if (character == DconAssembler::kEnd) {
      return assembler_.end(queue_, status, now_);
    }
    assembler_.byte(queue_, static_cast<std::uint8_t>(character), status);
    return Verdict::Open;
  }

  /// Passes all characters to the assembler and returns the last verdict. Only the last character may end a
  /// frame.
  Verdict put(std::string_view text) {
    Verdict last = Verdict::Open;
    for (const char character : text) {
      EXPECT_EQ(last, Verdict::Open) << "within " << text;
      last = put(character);
    }
    return last;
  }

  /// Returns the waiting frame as text and drops it; "nothing" if no frame waits.
  std::string taken() {
    const Frame* frame = queue_.has_frame() ? &queue_.waiting() : nullptr;
    if (frame == nullptr) {
      return "nothing";
    }
    const std::string text(frame->bytes().begin(), frame->bytes().end());
    queue_.drop_in_main_loop();
    return text;
  }

  /// Checks that the assembler waits for a delimiter and has kept no earlier character.
  void expect_hunting() {
    EXPECT_EQ(put("$01M\r"), Verdict::Accepted);
    EXPECT_EQ(taken(), "$01M");
  }

  FrameQueue queue_;
  DconAssembler assembler_;
  std::uint8_t own_ = kOwn;
  Time now_;
};

/// Returns a frame of `characters` characters that begins with `$01`, without checksum and CR. The
/// minimum of `characters` is 3.
inline std::string frame_of(std::size_t characters) { return "$01" + std::string(characters - 3, 'X'); }

}  // namespace ex9000
