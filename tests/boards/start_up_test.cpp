// Tests boards/cortex_m/start_up.cpp: the code that an image for the LM3S6965 or the TM4C123 runs before its
// `main`, after a return from `main`, and on a fault.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

// The image's `main` is renamed because the test program has its own `main`.
#define main main_of_the_image
#include "boards/cortex_m/start_up.cpp"
#undef main

namespace {

constexpr std::size_t kCopied = 3;
constexpr std::size_t kCleared = 16;
/// The number of words in the copied section, in the cleared section, and outside: one extra word before the
/// sections, one between them, and one after them. The extra words show whether the code writes outside the
/// sections.
constexpr std::size_t kWords = 1 + kCopied + 1 + kCleared + 1;

}  // namespace

// Defines the sections and symbols that the linker script defines on a board. A C++ array for each section
// would not work, because a sanitizer checks the bounds of each array.
asm(".pushsection .data\n"
    ".balign 4\n"
    ".globl memory_of_the_image, data_image, data_begin, data_end, zero_begin, zero_end\n"
    "data_image: .long 0x11111111, 0x22222222, 0x33333333, 0x44444444\n"
    "memory_of_the_image: .zero 4\n"
    "data_begin: .zero 12\n"
    "data_end: .zero 4\n"
    "zero_begin: .zero 64\n"
    "zero_end: .zero 4\n"
    ".popsection\n");
extern "C" std::array<std::uint32_t, kWords> memory_of_the_image;

namespace {

using Writes = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

class Reset {};  ///< thrown when the code resets the microcontroller
class Entered {};

Writes writes;
std::array<std::uint32_t, kWords> found_by_main{};
bool main_returns = false;

}  // namespace

namespace ex9000::hal::bus {

std::uint32_t read(std::uint32_t /*address*/) { return 0; }
void write(std::uint32_t address, std::uint32_t value) {
  writes.emplace_back(address, value);
  throw Reset();
}

}  // namespace ex9000::hal::bus

int main_of_the_image() {
  found_by_main = memory_of_the_image;
  if (!main_returns) {
    throw Entered();
  }
  return 0;
}

namespace {

/// AIRCR: VECTKEY and SYSRESETREQ (ARMv7-M Architecture Reference Manual, B3.2.6).
const Writes kTheReset{{0xE000'ED0C, 0x05FA'0004}};

class StartUpCode : public testing::Test {
 protected:
  StartUpCode() {
    writes.clear();
    main_returns = false;
    std::uint32_t noise = 0x9042;
    for (std::uint32_t& word : memory_of_the_image) {
      noise = noise * 1'664'525 + 1'013'904'223;
      word = noise | 1U;
    }
    before = memory_of_the_image;
  }
  std::array<std::uint32_t, kWords> before{};
};

TEST_F(StartUpCode, CopiesAndClearsExactlyTheLinkersSectionsBeforeMain) {
  std::array<std::uint32_t, kWords> expected = before;
  std::copy_n(std::array<std::uint32_t, kCopied>{0x1111'1111, 0x2222'2222, 0x3333'3333}.begin(), kCopied,
              expected.begin() + 1);
  std::fill_n(expected.begin() + 1 + kCopied + 1, kCleared, 0U);
  EXPECT_THROW(ex9000::start_up::reset_handler(), Entered);
  EXPECT_EQ(found_by_main, expected);
  EXPECT_TRUE(writes.empty());
}

TEST_F(StartUpCode, AReturnFromMainResetsTheMicrocontroller) {
  main_returns = true;
  EXPECT_THROW(ex9000::start_up::reset_handler(), Reset);
  EXPECT_EQ(writes, kTheReset);
}

TEST_F(StartUpCode, AFaultResetsTheMicrocontroller) {
  EXPECT_THROW(ex9000::start_up::fault_handler(), Reset);
  EXPECT_EQ(writes, kTheReset);
}

}  // namespace
