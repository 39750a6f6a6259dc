// Counts the instructions that images execute in QEMU, and compares the counts with limits. The count of a
// request contains all interrupts and the main loop, from the first received byte until the module is at rest
// again. Each limit is about 5 % above the count of 2026-11-29.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "firmware/model/baud.hpp"
#include "sim/app/play/modbus_frame.hpp"
#include "tests/qemu/signals.hpp"
#include "tests/qemu/timed_module.hpp"

namespace ex9000::rig {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using Bytes = TimedModule::Bytes;

constexpr unsigned kChannels = 8;

/// The requests are sent in turn, so that a stored value changes each time. In Modbus, they are hex digits
/// without the CRC; in ASCII, they have no CR.
struct Request {
  std::vector<std::string> frames;
  std::uint64_t most;
};

class CountedModule : public TimedModule {
 public:
  CountedModule(const char* designation, Protocol protocol, bool with_filter = false)
      : TimedModule(*find_model(designation)), ascii_(protocol == Protocol::Ascii) {
    Settings settings = Settings::factory(model());
    settings.protocol = protocol;
    settings.baud_code = kLastBaudCode;  // 115200
    if (with_filter) {
      settings.input_filters.set(0, 1);
    }
    begin_anew(&settings);
    run_for(milliseconds(100));
    const std::uint64_t before = instructions();
    run_for(kAtRest);
    millisecond_at_rest = static_cast<double>(instructions() - before) / static_cast<double>(kAtRest.count());
  }

  /// Returns the median of several passes. A pass is not exact, because a turn of the main loop can serve a
  /// request and a tick.
  std::uint64_t count_of(const std::vector<std::string>& frames) {
    constexpr milliseconds kWindow{30};
    std::array<std::uint64_t, 9> counts{};
    std::size_t pass = 0;
    for (std::uint64_t& count : counts) {
      const Bytes frame = framed(frames[pass++ % frames.size()]);
      run_for(milliseconds(13));
      const std::uint64_t before = instructions();
      const nanoseconds end = now() + kWindow;
      send(frame, mode());
      run_for(end - now());
      count = instructions() - before -
              static_cast<std::uint64_t>(millisecond_at_rest * static_cast<double>(kWindow.count()));
      hear(mode());
    }
    std::sort(counts.begin(), counts.end());
    return counts[counts.size() / 2];
  }

  double millisecond_at_rest = 0;

 private:
  static constexpr milliseconds kAtRest{1000};

  [[nodiscard]] Bytes framed(const std::string& request) const {
    if (ascii_) {
      Bytes frame(request.begin(), request.end());
      frame.push_back('\r');
      return frame;
    }
    Bytes frame;
    for (std::size_t at = 0; at < request.size(); at += 2) {
      frame.push_back(static_cast<std::uint8_t>(std::stoul(request.substr(at, 2), nullptr, 16)));
    }
    return with_crc(frame);
  }

  bool ascii_;
};

void expect_at_most(const char* model, Protocol protocol, const std::vector<Request>& requests) {
  CountedModule module(model, protocol);
  for (const Request& request : requests) {
    const std::uint64_t count = module.count_of(request.frames);
    std::printf("%-10s %-26s %6llu\n", model, request.frames[0].c_str(),
                static_cast<unsigned long long>(count));
    EXPECT_LE(count, request.most) << request.frames[0];
  }
  EXPECT_LE(module.millisecond_at_rest, 31);
}

TEST(Instructions, OfModbusRequestsToAModuleWithOutputs) {
  expect_at_most("EX9042D-M", Protocol::ModbusRtu,
                 {
                     {{"01010000000D"}, 1550},
                     {{"01050000FF00", "010500000000"}, 1660},
                     {{"010F0000000D025515", "010F0000000D02AA0A"}, 1880},
                     {{"010F00A0000D025515", "010F00A0000D02AA0A"}, 25500},  // stored
                 });
}

TEST(Instructions, OfModbusRequestsToAModuleWithInputs) {
  expect_at_most("EX9052D-M", Protocol::ModbusRtu,
                 {
                     {{"010100200008"}, 1520},
                     {{"010400000004"}, 1880},
                     {{"010F0200000801FF"}, 2050},  // clears eight counters
                     {{"010301E20004"}, 2020},
                     {{"010601E80064", "010601E80065"}, 25750},  // stored
                     {{"0108000000AA"}, 1590},
                     {{"0111"}, 1550},
                     {{"012B0E0200"}, 5310},
                     {{"014600"}, 1460},
                     {{"0155"}, 1260},         // exception
                     {{"020100000001"}, 650},  // for another address
                     {{"010330380000"}, 970},  // host OK
                 });
}

TEST(Instructions, OfAsciiRequestsToAModuleWithInputsAndOutputs) {
  expect_at_most("EX9055D", Protocol::Ascii,
                 {
                     {{"$012"}, 1260},
                     {{"$016"}, 1250},
                     {{"@01"}, 1160},
                     {{"@01A5", "@015A"}, 1210},
                     {{"#010"}, 1310},
                     {{"$01C"}, 1210},
                     {{"$01M"}, 1290},
                     {{"#0100A5", "#01005A"}, 1230},
                     {{"~01OPUMP", "~01OVALVE"}, 25570},  // stored
                     {{"~01Z"}, 1320},                    // refused
                     {{"$022"}, 290},                     // for another address
                     {{"~**"}, 540},                      // host OK
                     {{"#**"}, 780},                      // synchronised sampling
                 });
}

/// Computes how many pulses a TM4C123 can count (boards/ek-tm4c123gxl/README.md). It has a clock of 50 MHz.
/// The computation assumes 1.6 cycles per instruction, and 24 cycles for the entry and exit of an interrupt.
TEST(Instructions, OfEdgesPermitThePulsesThatTheDocumentStates) {
  constexpr double kHertz = 50e6;
  constexpr double kCyclesAnInstruction = 1.6;
  constexpr double kCyclesAnInterrupt = 24;
  constexpr double kInterruptsOfEdges = 2;  // the inputs are on two ports
  constexpr double kBytesASecond = 11'520;
  constexpr double kLeftToTheMainLoop = 0.1;
  constexpr unsigned kBursts = 40;
  // With a filter, the interrupt of an edge also reads the clock.
  CountedModule module("EX9052D-M", Protocol::ModbusRtu, true);
  QtestClient& bus = module.emulator().bus();
  // The edges of all inputs follow so soon that the processor executes nothing but their interrupts.
  const std::uint64_t before = module.instructions();
  for (unsigned burst = 0; burst < kBursts; ++burst) {
    for (unsigned channel = 0; channel < kChannels; ++channel) {
      set_pin_level(bus, input_pin(channel), burst % 2 == 0);
    }
    module.run_for(nanoseconds(1));
  }
  const double edges = static_cast<double>(module.instructions() - before) / kBursts;
  module.run_for(milliseconds(30));
  constexpr double kBytes = 8;
  const auto ignored = static_cast<double>(module.count_of({"020100000001"}));
  const double byte = kCyclesAnInstruction * ignored / kBytes + kCyclesAnInterrupt;
  const double of_edges = kCyclesAnInstruction * edges + kInterruptsOfEdges * kCyclesAnInterrupt;
  const double at_rest = kCyclesAnInstruction * 1000 * module.millisecond_at_rest;
  const double left = (1 - kLeftToTheMainLoop) * kHertz - kBytesASecond * byte - at_rest;
  const double pulses = left / of_edges / 2;
  // An edge waits at most for the other edges and for one run of each other interrupt. All these interrupts
  // together execute fewer instructions than a whole request for another module.
  constexpr double kOtherInterrupts = 7;
  const double wait = of_edges + kCyclesAnInstruction * ignored + kOtherInterrupts * kCyclesAnInterrupt;
  std::printf("%.0f instructions for an edge of each input; %.0f pulses a second; an edge waits %.1f us\n",
              edges, pulses, wait / kHertz * 1e6);
  EXPECT_GE(pulses, 23'000);
  EXPECT_LE(wait / kHertz, 45e-6);
}

}  // namespace
}  // namespace ex9000::rig
