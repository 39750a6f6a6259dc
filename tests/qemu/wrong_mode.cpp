#include "tests/qemu/wrong_mode.hpp"

#include "sim/virtual_line/wires/uart_sampler.hpp"

namespace ex9000::rig {

namespace {

using std::chrono::nanoseconds;

bool same_rate(std::uint32_t a, std::uint32_t b) {
  constexpr std::uint32_t kPercent = 2;
  return (a > b ? a - b : b - a) * 100ULL <= std::uint64_t{kPercent} * b;
}

nanoseconds duration_of_bits(std::uint32_t baud, std::uint64_t bits) {
  constexpr std::uint64_t kSecond = 1'000'000'000;
  return nanoseconds(bits * kSecond / baud);
}

}  // namespace

nanoseconds duration_in(SerialMode mode, std::size_t bytes) {
  return duration_of_bits(mode.baud, std::uint64_t{bytes} * bits_of_character(mode.format));
}

std::vector<Arrival> heard_in_mode(const std::vector<std::uint8_t>& bytes, SerialMode sent_in,
                                   SerialMode heard_in) {
  std::vector<Arrival> heard;
  if (heard_in.baud == 0 || sent_in.baud == 0) {
    return heard;
  }
  if (same_rate(sent_in.baud, heard_in.baud) &&
      sim::hear_each_other(sent_in, {sent_in.baud, heard_in.format})) {
    for (const std::uint8_t byte : bytes) {
      const nanoseconds until_report = duration_of_bits(sent_in.baud, bits_received(sent_in.format));
      heard.push_back({duration_in(sent_in, heard.size()) + until_report, byte, ByteStatus::Good});
    }
    return heard;
  }
  const SerialMode on_the_wires{sent_in.baud, sim::as_received(sent_in.format)};
  sim::Waves waves;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    waves.emplace_back(duration_in(sent_in, i), on_the_wires, sim::levels_of(bytes[i], on_the_wires.format));
  }
  // At different baud rates, the last byte can end much later for the receiver than for the sender.
  const sim::VirtualTime end = duration_in(sent_in, bytes.size()) + duration_in(heard_in, 2);
  sim::UartSampler sampler;
  while (const auto received = sampler.advance(waves, heard_in, end)) {
    heard.push_back({sampler.position(), received->byte, received->status});
  }
  return heard;
}

}  // namespace ex9000::rig
