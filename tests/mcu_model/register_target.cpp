#include "tests/mcu_model/register_target.hpp"

#include "sim/virtual_line/wires/module.hpp"

namespace ex9000::registers {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr milliseconds kComingUp{100};
constexpr microseconds kBetweenEdges{40};
constexpr milliseconds kFlashes{600};  ///< an LED that flashes at 2 Hz changes within this time

}  // namespace

void RegisterTarget::start(const Model& model, const Settings* preset) {
  if (preset != nullptr) {
    bench_.memory = sim::SimulatedModule::memory_image(model, *preset);
  }
  power(true);
}

void RegisterTarget::send(const play::Bytes& bytes) {
  const auto characters = static_cast<std::int64_t>(bytes.size());
  const Instant ends = bench_.timeline.now() + characters * bench_.line.character_time();
  bench_.line.send(bytes);
  bench_.run_until(ends);
}

play::Bytes RegisterTarget::receive(std::size_t count, milliseconds patience) {
  std::size_t had = bench_.line.heard.size();
  Instant gives_up = bench_.timeline.now() + patience;
  while (bench_.line.heard.size() < count && bench_.timeline.now() < gives_up) {
    bench_.run_for(bench_.line.character_time());
    if (bench_.line.heard.size() != had) {
      had = bench_.line.heard.size();
      gives_up = bench_.timeline.now() + patience;
    }
  }
  return take_heard();
}

play::Bytes RegisterTarget::listen(std::chrono::nanoseconds time) {
  bench_.run_for(time);
  return take_heard();
}

play::Bytes RegisterTarget::take_heard() {
  play::Bytes bytes;
  for (const LineBench::Heard& each : bench_.line.heard) {
    if (each.good) {  // a master drops a byte with wrong parity or without a stop bit
      bytes.push_back(each.byte);
    }
  }
  bench_.line.heard.clear();
  return bytes;
}

void RegisterTarget::power(bool on) {
  if (on == bench_.powered()) {
    return;
  }
  if (on) {
    bench_.power_on();
    bench_.run_for(kComingUp);
  } else {
    bench_.power_off();
  }
}

void RegisterTarget::reset() {
  bench_.reset();
  bench_.run_for(kComingUp);
}

void RegisterTarget::set_input(unsigned channel, bool level) {
  if (channel < bench_.image.inputs) {
    bench_.set_input(channel, level);
    bench_.run_for(kBetweenEdges);
  }
}

void RegisterTarget::pulse_input(unsigned channel, std::uint32_t count) {
  if (channel >= bench_.image.inputs || count == 0) {
    return;
  }
  const bool level = bench_.net(bench_.image.input_pins.at(channel)).level();
  std::uint32_t edges = 2 * count;
  Alarm edge(bench_.timeline, [&] {
    bench_.set_input(channel, edges % 2 == 0 ? !level : level);
    if (--edges != 0) {
      edge.set_after(kBetweenEdges);
    }
  });
  edge.set_after(Instant(1));
  bench_.run_for(kBetweenEdges * (2 * std::int64_t{count} + 1));
}

play::Led RegisterTarget::led(play::Led expected) {
  using play::Led;
  const bool lit = bench_.led();
  const Instant gives_up = bench_.timeline.now() + kFlashes;
  while (expected == Led::Flashing && bench_.timeline.now() < gives_up) {
    bench_.run_for(milliseconds(1));
    if (bench_.led() != lit) {
      return Led::Flashing;
    }
  }
  return lit ? Led::On : Led::Off;
}

}  // namespace ex9000::registers
