// The code that an image runs before its main, as it is shipped, on a piece of memory with a word before and
// behind what the linker marks.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

// Its `main` must not be the test program's.
#define main main_of_the_image
#include "boards/start_up.cpp"
#undef main

namespace {

constexpr std::size_t kMarked = 16;
constexpr std::size_t kWords = kMarked + 2;

}  // namespace

// What the linker script does on a board. An array in C++ would be an object of its own, whose bounds a
// sanitizer knows.
asm(".pushsection .bss\n"
    ".balign 4\n"
    ".globl memory_of_the_image, zero_begin, zero_end\n"
    "memory_of_the_image: .zero 4\n"
    "zero_begin: .zero 64\n"
    "zero_end: .zero 4\n"
    ".popsection\n");
extern "C" std::array<std::uint32_t, kWords> memory_of_the_image;

namespace {

using Writes = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

class Reset {};  ///< the microcontroller is told to reset itself
class Entered {};

Writes writes;
std::array<std::uint32_t, kWords> found_by_main{};
bool main_returns = false;

}  // namespace

namespace ex9000::hal::stellaris::bus {

std::uint32_t read(std::uint32_t /*address*/) { return 0; }
void write(std::uint32_t address, std::uint32_t value) {
  writes.emplace_back(address, value);
  throw Reset();
}

}  // namespace ex9000::hal::stellaris::bus

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

TEST_F(StartUpCode, ClearsEveryWordThatTheLinkerMarksAndNoOtherBeforeMain) {
  EXPECT_THROW(ex9000::start_up::reset_handler(), Entered);
  EXPECT_EQ(found_by_main.front(), before.front()) << "the word before what is marked";
  EXPECT_EQ(found_by_main.back(), before.back()) << "the word behind what is marked";
  for (std::size_t word = 1; word <= kMarked; ++word) {
    EXPECT_EQ(found_by_main.at(word), 0U) << word;
  }
  EXPECT_TRUE(writes.empty());
}

TEST_F(StartUpCode, AMainThatReturnsIsAFault) {
  main_returns = true;
  EXPECT_THROW(ex9000::start_up::reset_handler(), Reset);
  EXPECT_EQ(writes, kTheReset);
}

TEST_F(StartUpCode, AFaultResetsTheMicrocontroller) {
  EXPECT_THROW(ex9000::start_up::fault_handler(), Reset);
  EXPECT_EQ(writes, kTheReset);
}

}  // namespace
