#include "tests/firmware/noise/theory.hpp"

#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace ex9000::noise {

namespace {

/// A probability for each sum of characters, modulo 256.
using Sums = std::array<double, 256>;

unsigned ones(unsigned value) {
  unsigned count = 0;
  for (; value != 0; value &= value - 1) {
    ++count;
  }
  return count;
}

double choose(unsigned from, unsigned count) {
  double ways = 1;
  for (unsigned i = 0; i < count; ++i) {
    ways = ways * (from - i) / (i + 1);
  }
  return ways;
}

/// Returns the number of ways to choose `weight` of `bits` places so that an even number of the chosen places
/// is marked, minus the number of ways in which an odd number of the chosen places is marked. `marked`:
/// number of marked places.
double krawtchouk(unsigned bits, unsigned weight, unsigned marked) {
  double sum = 0;
  for (unsigned j = 0; j <= weight && j <= marked; ++j) {
    sum += (j % 2 == 0 ? 1 : -1) * choose(marked, j) * choose(bits - marked, weight - j);
  }
  return sum;
}

/// Returns, for each bit of a frame of `bits` bits, the change of the CRC if that bit is flipped. These
/// changes do not depend on the start value or on the other bits, because a CRC is linear except for its
/// start value.
std::vector<unsigned> syndromes(unsigned bits) {
  std::vector<unsigned> all;
  for (unsigned place = 0; place < bits; ++place) {
    unsigned crc = 0;
    for (unsigned bit = 0; bit < bits; ++bit) {
      crc ^= bit == place ? 1U : 0U;
      crc = crc % 2 != 0 ? crc / 2 ^ 0xA001U : crc / 2;
    }
    all.push_back(crc);
  }
  return all;
}

/// For each weight from 0 to 12: the number of words of one length with this weight that a CRC with the start
/// value 0 accepts. The weight of a word is the number of its 1 bits. Flips leave the CRC of a frame correct
/// if, and only if, the flipped bits are the 1 bits of such a word.
using Words = std::array<double, 13>;
Words words_of(unsigned bits) {
  const std::vector<unsigned> columns = syndromes(bits);
  std::vector<double> words_of_dual(bits + 1);
  for (unsigned row = 0; row < 65536; ++row) {
    unsigned weight = 0;
    for (const unsigned column : columns) {
      weight += ones(row & column) % 2;
    }
    words_of_dual[weight] += 1;
  }
  Words words{};
  for (unsigned weight = 0; weight < words.size(); ++weight) {
    for (unsigned marked = 0; marked <= bits; ++marked) {
      words[weight] += words_of_dual[marked] * krawtchouk(bits, weight, marked);
    }
    words[weight] = std::round(words[weight] / 65536);
  }
  return words;
}

/// Returns the probability that flips change `from` to `to`.
double becomes(unsigned from, unsigned to, double flipped_bit) {
  const unsigned flips = ones(from ^ to);
  return std::pow(flipped_bit, flips) * std::pow(1 - flipped_bit, 8 - flips);
}

bool in(char character, const char* set) { return std::string(set).find(character) != std::string::npos; }

/// Returns the probability that `text`, after the flips, is accepted as a frame if a CR follows: it begins
/// with a delimiter, contains no CR, and its last two characters are the checksum of the others.
double sum_fits(const std::string& text, double flipped_bit) {
  Sums sums{};
  sums[0] = 1;
  for (std::size_t i = 0; i + 2 < text.size(); ++i) {
    Sums next{};
    for (unsigned to = 0; to < 256; ++to) {
      const bool fits = i == 0 ? in(static_cast<char>(to), "#$%@~") : to != '\r';
      const double probability = fits ? becomes(static_cast<unsigned char>(text[i]), to, flipped_bit) : 0;
      for (unsigned sum = 0; probability > 0 && sum < 256; ++sum) {
        next[(sum + to) % 256] += sums[sum] * probability;
      }
    }
    sums = next;
  }
  constexpr char kDigits[] = "0123456789ABCDEF";
  double passes = 0;
  for (unsigned sum = 0; sum < 256; ++sum) {
    passes += sums[sum] *
              becomes(static_cast<unsigned char>(text[text.size() - 2]),
                      static_cast<unsigned char>(kDigits[sum / 16]), flipped_bit) *
              becomes(static_cast<unsigned char>(text.back()), static_cast<unsigned char>(kDigits[sum % 16]),
                      flipped_bit);
  }
  return passes;
}

/// Returns the result of `words_of` for a frame of `bytes` bytes. Computes it only once for each length.
const Words& known_words(std::size_t bytes) {
  static std::map<std::size_t, Words> known;
  const auto [place, fresh] = known.try_emplace(bytes);
  if (fresh) {
    place->second = words_of(static_cast<unsigned>(8 * bytes));
  }
  return place->second;
}

}  // namespace

double crc_misses_of(std::size_t bytes, unsigned flips) { return known_words(bytes)[flips]; }

double crc_misses(std::size_t bytes, double flipped_bit) {
  const Words& words = known_words(bytes);
  double missed = 0;
  for (unsigned weight = 1; weight < words.size(); ++weight) {
    missed += words[weight] * std::pow(flipped_bit, weight) *
              std::pow(1 - flipped_bit, static_cast<double>(8 * bytes - weight));
  }
  return missed;
}

double dcon_misses(const std::string& frame, bool checksum, double flipped_bit) {
  const double untouched = std::pow(1 - flipped_bit, 8 * (frame.size() + 1));
  const double cr_stays = becomes('\r', '\r', flipped_bit);
  double taken = 0;
  // The probability that no character so far was a delimiter or the first character of a reply.
  double hunting = 1;
  for (std::size_t begin = 0; begin + (checksum ? 5 : 3) <= frame.size() + 1; ++begin) {
    const std::string rest = frame.substr(begin);
    double opens = 0;
    double leads = 0;
    for (unsigned to = 0; to < 256; ++to) {
      const double probability = becomes(static_cast<unsigned char>(frame[begin]), to, flipped_bit);
      opens += in(static_cast<char>(to), "#$%@~") ? probability : 0;
      leads += in(static_cast<char>(to), "!>?") ? probability : 0;
    }
    if (checksum) {
      taken += hunting * (rest.size() >= 5 ? sum_fits(rest, flipped_bit) * cr_stays : 0);
    } else {
      // The frame ends at its own CR, or at the later CR if its own CR became another character. A frame of
      // two characters is accepted only in the second case, because an accepted frame has at least three.
      double others = 1;
      for (std::size_t i = 1; i < rest.size(); ++i) {
        others *= 1 - becomes(static_cast<unsigned char>(rest[i]), '\r', flipped_bit);
      }
      taken += hunting * opens * others * (rest.size() >= 3 ? 1 : 1 - cr_stays);
    }
    hunting *= 1 - opens - leads;
  }
  return taken - untouched;
}

namespace {

constexpr std::uint64_t kMany = 400;  // events from which the normal approximation is good enough

/// Returns the probability of at most `events` events. `mean`: at most a few hundred.
double at_most(std::uint64_t events, double mean) {
  double term = std::exp(-mean);
  double sum = term;
  for (std::uint64_t i = 1; i <= events; ++i) {
    term *= mean / static_cast<double>(i);
    sum += term;
  }
  return sum;
}

}  // namespace

double tail(std::uint64_t count, double mean) {
  if (mean > static_cast<double>(kMany)) {
    const double deviations = std::abs(static_cast<double>(count) - mean) / std::sqrt(mean);
    return std::erfc(deviations / std::sqrt(2.0)) / 2;
  }
  if (static_cast<double>(count) < mean) {
    return at_most(count, mean);
  }
  // the sum of the probabilities of `count` and more events; 1 - at_most would round a small result to 0
  double term = std::exp(-mean);
  for (std::uint64_t i = 1; i <= count; ++i) {
    term *= mean / static_cast<double>(i);
  }
  double sum = 0;
  for (std::uint64_t i = count + 1; term > sum * 1e-12; ++i) {
    sum += term;
    term *= mean / static_cast<double>(i);
  }
  return sum;
}

Interval interval_of(std::uint64_t count) {
  // For at most `kMany` events, finds two means by bisection. At the lower mean, the probability of at least
  // `count` events is 2.5 %. At the higher mean, the probability of at most `count` events is 2.5 %.
  // Exception: for 0 events, the lower mean is 0. For more than `kMany` events, uses the normal
  // approximation.
  if (count > kMany) {
    const double half_width = 1.96 * std::sqrt(static_cast<double>(count));
    return {static_cast<double>(count) - half_width, static_cast<double>(count) + half_width};
  }
  const auto find = [](auto too_high) {
    double low = 0;
    double high = 2.0 * kMany;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (too_high(middle) ? high : low) = middle;
    }
    return low;
  };
  return {count == 0 ? 0 : find([&](double mean) { return 1 - at_most(count - 1, mean) > 0.025; }),
          find([&](double mean) { return at_most(count, mean) < 0.025; })};
}

}  // namespace ex9000::noise
