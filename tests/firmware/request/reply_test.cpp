// Tests how a reply is written, also if a handler appends more than the buffer can hold.
#include "firmware/request/reply.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace ex9000 {
namespace {

std::string text_of(const Reply& reply) { return {reply.bytes().begin(), reply.bytes().end()}; }

TEST(Reply, PatchOverwritesAByteAndNeverAddsOne) {
  Reply reply;
  reply.put(std::string_view("0123"));
  reply.patch(2, 'x');
  reply.patch(4, 'y');
  EXPECT_EQ(text_of(reply), "01x3");
}

TEST(Reply, DropsWhatExceedsTheLongestFrame) {
  struct {
    Reply reply;
    std::array<std::uint8_t, 8> after_it{};
  } memory;
  Reply& reply = memory.reply;
  for (unsigned i = 0; i < kLongestFrame; ++i) {
    reply.put(static_cast<std::uint8_t>(i));
  }
  reply.put('!');
  reply.put_hex(0x55);
  reply.put_word(0x5555);
  reply.put(std::string_view("55"));
  reply.patch(kLongestFrame, '5');
  ASSERT_EQ(reply.size(), kLongestFrame);
  EXPECT_EQ(reply.bytes()[kLongestFrame - 1], static_cast<std::uint8_t>(kLongestFrame - 1));
  EXPECT_EQ(memory.after_it, (std::array<std::uint8_t, 8>{}));
}

}  // namespace
}  // namespace ex9000
