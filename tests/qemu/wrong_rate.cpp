#include "tests/qemu/wrong_rate.hpp"

#include "sim/bus/uart_sampler.hpp"

namespace ex9000::rig {

namespace {

bool same_rate(std::uint32_t a, std::uint32_t b) {
  constexpr std::uint32_t kPercent = 2;
  return (a > b ? a - b : b - a) * 100ULL <= std::uint64_t{kPercent} * b;
}

}  // namespace

std::chrono::nanoseconds duration_at(std::uint32_t baud, std::size_t bytes) {
  constexpr std::int64_t kCharacter = 10'000'000'000;  // 10 bits at 1 baud, in ns
  return std::chrono::nanoseconds(static_cast<std::int64_t>(bytes) * kCharacter / baud);
}

std::vector<Arrival> heard_at_rate(const std::vector<std::uint8_t>& bytes, std::uint32_t sent_at,
                                   std::uint32_t heard_at) {
  std::vector<Arrival> heard;
  if (heard_at == 0 || sent_at == 0) {
    return heard;
  }
  if (same_rate(sent_at, heard_at)) {
    for (const std::uint8_t byte : bytes) {
      heard.push_back({duration_at(sent_at, heard.size() + 1), byte});
    }
    return heard;
  }
  sim::Waves waves;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    waves.push_back({duration_at(sent_at, i), sent_at, bytes[i]});
  }
  // At different baud rates, the last byte can end much later for the receiver than for the sender.
  const sim::VirtualTime end = duration_at(sent_at, bytes.size()) + duration_at(heard_at, 2);
  sim::UartSampler sampler;
  while (const auto received = sampler.advance(waves, heard_at, end)) {
    heard.push_back({sampler.position(), received->byte});
  }
  return heard;
}

}  // namespace ex9000::rig
