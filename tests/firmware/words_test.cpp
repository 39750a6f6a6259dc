// Objects as the words they lie in.
#include "firmware/words.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

namespace ex9000 {
namespace {

/// Fields of every size, without padding.
struct Mixed {
  std::uint8_t first = 0x11;
  std::uint8_t second = 0x22;
  std::uint16_t half = 0x4433;
  std::uint32_t whole = 0x8877'6655;
  alignas(4) std::array<std::uint8_t, 4> bytes{0x99, 0xAA, 0xBB, 0xCC};
};

TEST(Words, AreAsManyAsTheObjectIsLong) {
  EXPECT_EQ(kWordsOf<Mixed>, 3U);
  EXPECT_EQ(kWordsOf<std::uint32_t>, 1U);
}

TEST(Words, AreTheBytesOfTheObjectLowByteFirst) {
  const Mixed object;
  EXPECT_EQ(words_of(object)[0], 0x4433'2211U);
  EXPECT_EQ(words_of(object)[1], 0x8877'6655U);
  EXPECT_EQ(words_of(object)[2], 0xCCBB'AA99U);
}

TEST(Words, ThatAreWrittenAreSeenInTheFields) {
  Mixed object;
  Word* words = words_of(object);
  words[0] = 0x0403'0201;
  words[1] = 0x0807'0605;
  words[2] = 0x0C0B'0A09;
  EXPECT_EQ(object.first, 0x01);
  EXPECT_EQ(object.second, 0x02);
  EXPECT_EQ(object.half, 0x0403);
  EXPECT_EQ(object.whole, 0x0807'0605U);
  EXPECT_EQ(object.bytes, (std::array<std::uint8_t, 4>{0x09, 0x0A, 0x0B, 0x0C}));
}

TEST(Words, ShowAFieldThatIsWrittenBehindTheirBack) {
  Mixed object;
  const Word* words = words_of(static_cast<const Mixed&>(object));
  EXPECT_EQ(words[0], 0x4433'2211U);
  object.half = 0xBEEF;
  object.second = 0;
  EXPECT_EQ(words[0], 0xBEEF'0011U);
}

TEST(SameWords, AreOfEqualBytes) {
  const Mixed one;
  const Mixed other;
  EXPECT_TRUE(same_words(words_of(one), words_of(other), kWordsOf<Mixed>));
}

TEST(SameWords, AreNotWhereAnyBitDiffers) {
  const Mixed one;
  for (std::size_t bit = 0; bit < 32 * kWordsOf<Mixed>; ++bit) {
    Mixed other;
    words_of(other)[bit / 32] ^= 1U << (bit % 32);
    EXPECT_FALSE(same_words(words_of(one), words_of(other), kWordsOf<Mixed>)) << bit;
    EXPECT_FALSE(same_words(words_of(other), words_of(one), kWordsOf<Mixed>)) << bit;
  }
}

TEST(SameWords, LookAtNoMoreThanTheyAreTold) {
  const Mixed one;
  Mixed other;
  words_of(other)[2] = 0;
  EXPECT_TRUE(same_words(words_of(one), words_of(other), 2));
  words_of(other)[0] = 0;
  EXPECT_TRUE(same_words(words_of(one), words_of(other), 0));
}

}  // namespace
}  // namespace ex9000
