#include "firmware/bytes.hpp"

#include <gtest/gtest.h>

namespace ex9000 {
namespace {

TEST(Bytes, AreEmptyByDefault) {
  EXPECT_EQ(Bytes().size, 0U);
  EXPECT_EQ(Bytes().data, nullptr);
  EXPECT_EQ(MutableBytes().size, 0U);
  EXPECT_EQ(MutableBytes().data, nullptr);
}

}  // namespace
}  // namespace ex9000
