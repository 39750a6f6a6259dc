// Calculates how many damaged frames a check accepts if each data bit is flipped with the same probability,
// independently of the other bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace ex9000::noise {

/// Returns how many of the ways to flip `flips` bits of a Modbus RTU frame leave its CRC correct. `bytes`:
/// length of the frame with its CRC. `flips`: 0 to 12. Uses the weights of the words of the dual code and the
/// MacWilliams identity.
double crc_misses_of(std::size_t bytes, unsigned flips);

/// Returns the probability that a Modbus RTU frame arrives damaged with a correct CRC. `bytes`: length of the
/// frame with its CRC. Ignores more than 12 flips: if `flipped_bit` is at most 0.01 and the frame has at most
/// 20 bytes, they contribute less than a millionth of the sum.
double crc_misses(std::size_t bytes, double flipped_bit);

/// Returns the probability that a DCON frame arrives damaged and is accepted. `frame` begins with its
/// delimiter and ends before CR; it includes the checksum if there is one. Two CRs follow `frame`: its own
/// CR, which can be damaged, and later a second CR, which is not damaged. Ignores frames that end early
/// because a character has become a CR: all characters of the requests in the tests require at least three
/// flips for that. With a checksum, also ignores frames whose own CR has become another character.
double dcon_misses(const std::string& frame, bool checksum, double flipped_bit);

/// A 95 % confidence interval of the mean of a Poisson variable.
struct Interval {
  double low;
  double high;
};
/// Returns the interval for a variable that has produced `count` events.
Interval interval_of(std::uint64_t count);

/// Returns the probability that a Poisson variable with this mean is at least as far from the mean as
/// `count`, on the same side. The result is about 0.5 if `count` is near the mean.
double tail(std::uint64_t count, double mean);

}  // namespace ex9000::noise
