// How many damaged frames a check lets through, by reckoning: every bit of every byte is flipped with the
// same probability, by itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace ex9000::noise {

/// How many of the ways to flip so many bits of a Modbus RTU frame of so many bytes, its CRC among them,
/// leave its CRC right. From the weights of the words of the code's dual, by MacWilliams' identity. `flips`:
/// 0 to 12.
double crc_misses_of(std::size_t bytes, unsigned flips);

/// The probability that a Modbus RTU frame of so many bytes, its CRC among them, arrives damaged and its CRC
/// is right all the same. More than 12 flips are left out, which for a probability of 0.01 and 20 bytes or
/// fewer is less than a millionth of the sum.
double crc_misses(std::size_t bytes, double flipped_bit);

/// That a DCON frame arrives damaged and is taken for a frame all the same. `frame` begins with its delimiter
/// and ends before CR, its checksum included where there is one; a CR that nothing hits follows later.
/// Left out are frames that end early, at a character that has become a CR, for which all characters used
/// here want four flips at least; and with a checksum, those whose own CR has become another character.
double dcon_misses(const std::string& frame, bool checksum, double flipped_bit);

/// The 95 % interval of a Poisson variable's mean of which `count` events were seen.
struct Interval {
  double low;
  double high;
};
Interval interval_of(std::uint64_t count);

}  // namespace ex9000::noise
