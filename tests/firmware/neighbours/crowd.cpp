#include "tests/firmware/neighbours/crowd.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/notation/module_notation.hpp"
#include "tests/oracles/reference/dcon_check.hpp"
#include "tests/oracles/reference/hexadecimal.hpp"

namespace ex9000::neighbours {

namespace {

using reference::Bytes;
using sim::VirtualTime;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr std::size_t kMaster = 0;
/// The models of the modules; the list repeats until there are 32 modules. `ascii`: an -M model that runs
/// ASCII. The first module receives the pulses.
constexpr std::array<const char*, 9> kCrowd{"EX9052D-M", "EX9042D-M,ascii", "EX9043D-M",
                                            "EX9052D",   "EX9068D-M",       "EX9055D",
                                            "EX9042D-M", "EX9052D-M,ascii", "EX9068AD-M"};
/// The longest times from the end of a request until its reply begins, without and with a store. The limits
/// in wire.md, sections 3 and 7, are 20 ms and 200 ms. These constants also include a margin, and the silence
/// that ends a Modbus request.
constexpr milliseconds kAnswers{25};
constexpr milliseconds kAnswersStoring{210};

bool in_ascii(const std::string& member) {
  return member.find("ascii") != std::string::npos || member.find("-M") == std::string::npos;
}
std::string designation_of(const std::string& member) { return member.substr(0, member.find(',')); }

std::vector<sim::ModuleSpec> specs(std::uint32_t baud) {
  std::vector<sim::ModuleSpec> all;
  for (unsigned i = 0; i < Crowd::kModules; ++i) {
    const std::string member = kCrowd[i % kCrowd.size()];
    all.push_back(sim::parse_module_spec(designation_of(member) + "@" + reference::hex(i + 1, 2) +
                                         ",baud=" + std::to_string(baud) +
                                         (in_ascii(member) ? ",protocol=ascii,checksum=on" : "")));
  }
  return all;
}

reference::Module described(std::size_t index, std::uint32_t baud) {
  const std::string member = kCrowd[index % kCrowd.size()];
  const auto* row = std::find_if(
      std::begin(reference::kModelRows), std::end(reference::kModelRows),
      [&](const reference::ModelRow& each) { return each.designation == designation_of(member); });
  reference::Module module(*row);
  constexpr std::array<std::uint32_t, 8> kRates{1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200};
  reference::Stored stored = module.stored();
  stored.address = static_cast<unsigned>(index + 1);
  stored.baud_code =
      static_cast<unsigned>(std::find(kRates.begin(), kRates.end(), baud) - kRates.begin()) + 3;
  stored.modbus = !in_ascii(member);
  stored.format = in_ascii(member) ? 0x40 : 0x00;
  module.store(stored);
  module.power(true, VirtualTime(0));
  module.take_rules();
  return module;
}

}  // namespace

void Pulser::start(std::uint32_t per_second) {
  period_ = VirtualTime(1'000'000'000 / per_second);
  wake_at(clock_.virtual_now() + period_);
}

void Pulser::resume() {
  if (period_ != VirtualTime(0) && next_ == sim::kNever) {
    wake_at(clock_.virtual_now() + period_);
  }
}

void Pulser::run() {
  for (unsigned channel = 0; channel < 8; ++channel) {
    module_.pulse_input(channel, 1);
  }
  ++pulses_;
  wake_at(next_ + period_);
}

Crowd::Crowd(std::uint32_t baud, std::uint64_t seed)
    : random_(seed),
      line_(specs(baud), sim::kPaced, [this](std::uint8_t byte, ByteStatus) { heard_.push_back(byte); }),
      pulser_(line_.wires(), line_.module(0)) {
  for (std::size_t i = 0; i < kModules; ++i) {
    described_.push_back(described(i, baud));
  }
  line_.wires().observe(*this);
  line_.come_up();
  line_.master().set_baud(baud);
}

Bytes Crowd::modbus_request(std::size_t module) {
  const auto address = static_cast<std::uint8_t>(module + 1);
  const reference::ModelRow& row = described_[module].row();
  const auto channel = static_cast<std::uint8_t>(row.outputs != 0 ? random_.below(row.outputs) : 0);
  const auto on = static_cast<std::uint8_t>(random_.once_in(2) ? 0xFF : 0x00);
  const auto any = static_cast<std::uint8_t>(random_.between(1, 255));
  switch (random_.below(8)) {
    case 0:
      return {address, 3, 1, 0xE2, 0, 4};
    case 1:
      return {address, 6, 1, 0xE8, 0, any};  // stores the host watchdog's timeout
    case 2:
      return {address, 0x11};
    case 3:
      return row.inputs != 0 ? Bytes{address, 3, 0, 0, 0, 8} : Bytes{address, 5, 0, channel, on, 0};
    case 4:
      return row.inputs != 0 ? Bytes{address, 2, 0, 0, 0, 8} : Bytes{address, 5, 0, channel, on, 0};
    case 5:
      return row.inputs != 0 ? Bytes{address, 1, 0, 0x40, 0, 8}
                             : Bytes{address, 5, 0, 0x80, on, 0};  // safe value
    case 6:
      return row.inputs != 0 ? Bytes{address, 0x44, 0, 0}
                             : Bytes{address, 5, 0, 0xA0, on, 0};  // power-on value
    default:
      return row.inputs != 0 ? Bytes{address, 3, 0, 0, 0, 8} : Bytes{address, 1, 0, 0, 0, 8};
  }
}

std::string Crowd::dcon_request(std::size_t module) {
  const std::string address = reference::hex(static_cast<unsigned>(module + 1), 2);
  const reference::ModelRow& row = described_[module].row();
  // A model with inputs and outputs gets requests for both.
  const bool inputs = row.inputs != 0 && (row.outputs == 0 || random_.once_in(2));
  switch (random_.below(9)) {
    case 0:
      return "$" + address + "M";
    case 1:
      return "~" + address + "O" + reference::hex(random_.below(65536), 4);  // stores a name
    case 2:
      return "$" + address + "6";
    case 3:
      return "@" + address;
    case 4:
      return inputs
                 ? "#" + address + std::to_string(random_.below(row.inputs))
                 : "@" + address + reference::hex(random_.below(1U << row.outputs), row.outputs > 8 ? 4 : 2);
    case 5:
      return inputs ? "$" + address + "L1" : "~" + address + "5S";  // stores the safe value
    case 6:
      return inputs ? "$" + address + "C" : "~" + address + "5P";
    case 7:
      return "~" + address + "30" +
             reference::hex(random_.between(1, 255), 2);  // the host watchdog's timeout
    default:
      return "$" + address + "2";
  }
}

Bytes Crowd::a_request(std::size_t module) {
  if (random_.once_in(40)) {
    return with_crc({0, 3, 0x30, 0x38, 0, 0});  // host OK
  }
  std::string text;
  if (random_.once_in(40)) {
    text = random_.once_in(2) ? "#**" : "~**";
  } else if (described_[module].runs_modbus()) {
    return with_crc(modbus_request(module));
  } else {
    text = dcon_request(module);
  }
  text += reference::check_of(text) + "\r";
  return {text.begin(), text.end()};
}

/// Passes the pulses to the reference model of the pulsed module. Call this only between requests, because
/// during a request the timing decides which edges a reply includes.
void Crowd::account_for_pulses() {
  const std::uint32_t pulses = pulser_.take();
  pulses_ += pulses;
  for (unsigned channel = 0; pulses != 0 && channel < 8; ++channel) {
    described_[0].pulse_input(channel, pulses, now());
  }
}

void Crowd::exchange() {
  const std::size_t module = random_.below(kModules);
  const Bytes request = a_request(module);
  const VirtualTime takes = line_.master().takes(request.size());
  // The pulses pause during a request to the pulsed module, because many of these requests read inputs.
  // Exception: the pulses continue during function 06, which reads no input.
  if (module == 0 && request[1] != 6) {
    pulser_.pause();
  }
  account_for_pulses();

  heard_.clear();
  spoke_.clear();
  line_.master().send(request.data(), request.size());
  line_.wires().run_for(takes);
  reference::Answer expected;
  for (reference::Module& each : described_) {
    reference::Answer answer = each.on_request(request, now());
    each.take_rules();
    ASSERT_EQ(answer.left_open, nullptr);
    if (!answer.reply.empty()) {
      ASSERT_TRUE(expected.reply.empty()) << "two reference models reply";
      expected = std::move(answer);
    }
  }
  const VirtualTime most =
      VirtualTime(expected.stores ? kAnswersStoring : kAnswers) + line_.master().takes(expected.reply.size());
  const VirtualTime end = now() + most;
  while (now() < end && (spoke_.empty() || line_.wires().busy())) {
    line_.wires().run_until(std::min(line_.wires().next(), end));
  }
  ASSERT_FALSE(collided_) << "two drivers were on";
  ASSERT_EQ(heard_, expected.reply) << "the reply to " << testing::PrintToString(request);
  if (expected.reply.empty()) {
    ASSERT_TRUE(spoke_.empty());
    ++broadcasts_;
  } else {
    ASSERT_EQ(spoke_, std::vector<std::size_t>{module + 1});
    ++replies_;
    ++of_each_[module];
    stores_ += expected.stores ? 1U : 0U;
    // The other modules receive the reply too.
    for (std::size_t i = 0; i < kModules; ++i) {
      if (i != module) {
        ASSERT_TRUE(described_[i].on_request(heard_, now()).reply.empty());
        described_[i].take_rules();
      }
    }
  }
  // After a reply, the next request follows as early as possible: when the silence is over.
  line_.wires().run_for(line_.rtu_silence() + microseconds(10));
  expect_outputs_as_described();
  pulser_.resume();
}

void Crowd::expect_outputs_as_described() {
  for (std::size_t i = 0; i < kModules; ++i) {
    const unsigned outputs = line_.module(i).outputs();
    ASSERT_EQ(outputs, described_[i].outputs()) << "module " << i + 1;
    ever_on_[i] |= outputs;
  }
}

void Crowd::driver(std::size_t station, bool on, VirtualTime /*now*/) {
  if (on && station != kMaster) {
    spoke_.push_back(station);
  }
}

}  // namespace ex9000::neighbours
