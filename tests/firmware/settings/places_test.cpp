// Tests the places at which copies of the settings are stored.
#include "firmware/settings/places.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

namespace ex9000 {
namespace {

TEST(Places, HaveTheAddressesThatExistingModulesUse) {
  ASSERT_EQ(kPlaces.size(), 4U);
  EXPECT_EQ(kPlaces[0].address, 0x0080);
  EXPECT_EQ(kPlaces[1].address, 0x0100);
  EXPECT_EQ(kPlaces[2].address, 0x0000);
  EXPECT_EQ(kPlaces[3].address, 0x0020);
}

TEST(Places, ShareNoPage) {
  for (const Place& a : kPlaces) {
    EXPECT_EQ(a.address % kMemoryPage, 0U);
    for (const Place& b : kPlaces) {
      const std::size_t room = a.old ? kMemoryPage : kRecordRoom;
      EXPECT_TRUE(&a == &b || b.address >= a.address + room || b.address < a.address);
    }
  }
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
