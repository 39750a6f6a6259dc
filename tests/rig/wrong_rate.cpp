#include "tests/rig/wrong_rate.hpp"

#include "sim/uart_sampler.hpp"

namespace ex9000::rig {

bool same_rate(std::uint32_t a, std::uint32_t b) {
  constexpr std::uint32_t kPercent = 2;
  return (a > b ? a - b : b - a) * 100ULL <= std::uint64_t{kPercent} * b;
}

std::vector<std::uint8_t> heard_at_rate(const std::vector<std::uint8_t>& bytes, std::uint32_t sent_at,
                                        std::uint32_t heard_at) {
  if (heard_at == 0 || sent_at == 0) {
    return {};
  }
  if (same_rate(sent_at, heard_at)) {
    return bytes;
  }
  constexpr std::int64_t kCharacter = 10'000'000'000;  // bits, in ns
  sim::Waves waves;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    waves.push_back(
        {sim::VirtualTime(static_cast<std::int64_t>(i) * kCharacter / sent_at), sent_at, bytes[i]});
  }
  // The last byte may be over for the sender long before it is for the receiver.
  const sim::VirtualTime end(static_cast<std::int64_t>(bytes.size()) * kCharacter / sent_at +
                             2 * kCharacter / heard_at);
  sim::UartSampler sampler;
  std::vector<std::uint8_t> heard;
  while (const auto received = sampler.advance(waves, heard_at, end)) {
    heard.push_back(received->byte);
  }
  return heard;
}

}  // namespace ex9000::rig
