// Tests the places at which copies of the settings are stored.
#include "firmware/settings/places.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

namespace ex9000 {
namespace {

TEST(Places, ShareNoPage) {
  EXPECT_EQ(kPlaces[0] % kMemoryPage, 0U);
  EXPECT_EQ(kPlaces[1] % kMemoryPage, 0U);
  EXPECT_GE(kPlaces[1], kPlaces[0] + kRecordRoom);
}

TEST(Places, AreBlankIfAndOnlyIfAllBytesOfTheFirstPageAreFF) {
  std::array<std::uint8_t, kMemoryPage> page{};
  page.fill(0xFF);
  EXPECT_TRUE(is_blank({page.data(), page.size()}));
  for (std::size_t bit = 0; bit < page.size() * 8; ++bit) {
    page[bit / 8] = static_cast<std::uint8_t>(page[bit / 8] ^ (1U << (bit % 8)));
    EXPECT_FALSE(is_blank({page.data(), page.size()})) << bit;
    page[bit / 8] = 0xFF;
  }
}

}  // namespace
}  // namespace ex9000
