// Tests `crc_misses_of`. For a frame of 8 bytes, compares its results with an exhaustive count.
#include "tests/firmware/noise/theory.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "tests/oracles/judges/checks.hpp"

namespace ex9000::noise {
namespace {

/// Returns, for each bit of a frame of `bytes` bytes, the change of the CRC if that bit is flipped. Computes
/// the CRCs before and after the flip with judges::crc16, without the code of theory.cpp.
std::vector<unsigned> syndromes_of(std::size_t bytes) {
  std::vector<std::uint8_t> frame(bytes, 0xA5);
  const unsigned untouched = judges::crc16(frame.data(), bytes);
  std::vector<unsigned> all;
  for (std::uint8_t& byte : frame) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      byte = static_cast<std::uint8_t>(byte ^ (1U << bit));
      all.push_back(judges::crc16(frame.data(), bytes) ^ untouched);
      byte = static_cast<std::uint8_t>(byte ^ (1U << bit));
    }
  }
  return all;
}

/// The result of `count_misses`, which tries all ways to flip 1 to 4 bits.
struct Misses {
  std::array<std::uint64_t, 5> of{};  ///< [n]: ways to flip n bits, 1 to 4, that leave the CRC unchanged
  std::uint64_t tried_with_four = 0;  ///< number of ways to flip four bits
};

Misses count_misses(std::size_t bytes) {
  const std::vector<unsigned> all = syndromes_of(bytes);
  const unsigned* syndromes = all.data();
  const std::size_t bits = all.size();
  Misses misses;
  for (std::size_t a = 0; a < bits; ++a) {
    const unsigned one = syndromes[a];
    misses.of[1] += one == 0 ? 1U : 0U;
    for (std::size_t b = a + 1; b < bits; ++b) {
      const unsigned two = one ^ syndromes[b];
      misses.of[2] += two == 0 ? 1U : 0U;
      for (std::size_t c = b + 1; c < bits; ++c) {
        const unsigned three = two ^ syndromes[c];
        misses.of[3] += three == 0 ? 1U : 0U;
        for (std::size_t d = c + 1; d < bits; ++d) {
          misses.of[4] += three == syndromes[d] ? 1U : 0U;
        }
        misses.tried_with_four += bits - c - 1;
      }
    }
  }
  return misses;
}

TEST(Theory, MatchesAnExhaustiveCountOfOneToFourFlipsThatTheCrcMissesIn8Bytes) {
  const Misses misses = count_misses(8);  // for example a request of function 01 or 05
  EXPECT_EQ(misses.tried_with_four, 635'376U);
  EXPECT_GT(misses.of[4], 0U);
  for (unsigned flips = 1; flips <= 4; ++flips) {
    EXPECT_EQ(crc_misses_of(8, flips), static_cast<double>(misses.of[flips])) << flips << " flips";
  }
}

TEST(Theory, ExpectsNoMissOfOneToThreeFlipsInAFrameOf11Bytes) {
  for (unsigned flips = 1; flips <= 3; ++flips) {
    EXPECT_EQ(crc_misses_of(11, flips), 0) << flips << " flips";
  }
}

// The expected values are from a table of the Poisson distribution, and the last one from a table of the
// normal distribution (0.994 standard deviations).
TEST(Theory, TheTailIsTheProbabilityOfACountAtLeastAsFarFromTheMean) {
  EXPECT_EQ(tail(0, 0), 1);
  EXPECT_NEAR(tail(1, 5.47e-10), 5.47e-10, 1e-15);
  EXPECT_NEAR(tail(2, 0.022), 2.385e-4, 1e-7);
  EXPECT_NEAR(tail(0, 7.5), 5.531e-4, 1e-7);
  EXPECT_NEAR(tail(5, 5), 0.5595, 1e-4);
  EXPECT_NEAR(tail(4, 5), 0.4405, 1e-4);
  EXPECT_NEAR(tail(2580, 2530), 0.1601, 1e-4);
}

}  // namespace
}  // namespace ex9000::noise
