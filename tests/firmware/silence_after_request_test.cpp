// In this file, the silence after a request means T3.5 in Modbus and the turn-around in ASCII. These tests
// check that the module processes a request only at the end of this silence, and that events during the
// silence still affect the request: wire.md sections 3, 7 and 8.
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using Bytes = ModuleBench::Bytes;

/// Less than both silences. At 9600 baud, the turn-around is 1.04 ms and T3.5 is 4.01 ms.
constexpr microseconds kWithinAnySilence{300};
constexpr milliseconds kLong{50};

const Bytes kReadInputs{0x01, 0x02, 0x00, 0x00, 0x00, 0x08};
const Bytes kReadCounter0{0x01, 0x03, 0x00, 0x00, 0x00, 0x01};
const Bytes kReadOutputs{0x01, 0x01, 0x00, 0x00, 0x00, 0x08};
const Bytes kOutput0On{0x01, 0x05, 0x00, 0x00, 0xFF, 0x00};
const Bytes kBusMessages{0x01, 0x08, 0x00, 0x0B, 0x00, 0x00};

/// Sends a request, calls `event` during the silence after the request, and returns the reply.
template <class Event>
std::string answer(ModuleBench& bench, const std::string& command, Event event) {
  bench.forget_heard();
  bench.send(command + "\r");
  bench.run(kWithinAnySilence);
  EXPECT_EQ(bench.heard_text(), "");
  event();
  bench.run(kLong);
  return bench.heard_text();
}
template <class Event>
Bytes answer(ModuleBench& bench, const Bytes& frame, Event event) {
  bench.forget_heard();
  bench.send(with_crc(frame));
  bench.run(kWithinAnySilence);
  EXPECT_EQ(bench.heard_text(), "");
  event();
  bench.run(kLong);
  const std::string heard = bench.heard_text();
  return {heard.begin(), heard.end()};
}

TEST(SilenceAfterRequest, AnInputChangeDuringTheSilenceIsInTheModbusReply) {
  ModuleBench bench("EX9052D-M");
  EXPECT_EQ(answer(bench, kReadInputs, [&] { bench.module().set_input(3, true); }),
            with_crc({0x01, 0x02, 0x01, 0x08}));
  EXPECT_EQ(answer(bench, kReadCounter0, [&] { bench.module().pulse_input(0, 5); }),
            with_crc({0x01, 0x03, 0x02, 0x00, 0x05}));
}

TEST(SilenceAfterRequest, AnInputChangeDuringTheTurnAroundIsInTheAsciiReply) {
  ModuleBench bench("EX9052D");
  EXPECT_EQ(answer(bench, "$016", [&] { bench.module().set_input(0, true); }), "!010000\r");
  EXPECT_EQ(answer(bench, "#012", [&] { bench.module().pulse_input(2, 7); }), "!0100007\r");
}

TEST(SilenceAfterRequest, AnOutputCommandIsRefusedIfTheHostWatchdogExpiresDuringTheSilence) {
  constexpr milliseconds kTimeout{100};
  constexpr microseconds kCommand{8 * 10'000'000 / 9600};
  constexpr microseconds kBeforeTheTimeout{500};
  ModuleBench bench("EX9043D");
  bench.ask("~013101");
  bench.ask("~011");
  bench.send("~013101\r");
  bench.run(kLong);
  bench.send("~**\r");
  const VirtualTime times_out = bench.now() + kTimeout;
  bench.line().wires().run_until(times_out - kBeforeTheTimeout - kCommand);
  bench.forget_heard();
  bench.send("@010001\r");
  EXPECT_LT(bench.now(), times_out);
  EXPECT_FALSE(bench.module().module().state().settings.timeout_status);
  bench.run(kLong);
  EXPECT_EQ(bench.heard_text(), "!\r");
  EXPECT_EQ(bench.module().outputs(), 0U);
}

TEST(SilenceAfterRequest, OutputsChangeOnlyAtTheEndOfTheSilence) {
  for (const char* model : {"EX9042D", "EX9042D-M"}) {
    ModuleBench bench(model);
    std::vector<OutputChange> changes;
    bench.watch_outputs(changes);
    const bool ascii = bench.module().module().state().in_force.protocol == Protocol::Ascii;
    if (ascii) {
      bench.send(std::string("@010001\r"));
    } else {
      bench.send(with_crc(kOutput0On));
    }
    const VirtualTime ended = bench.now();
    bench.run(kLong);
    ASSERT_EQ(changes.size(), 1U) << model;
    // The silence is one character of ten bits in ASCII, and 3.5 characters of eleven bits in Modbus.
    EXPECT_GE(changes[0].at - ended, ascii ? microseconds(1041) : microseconds(4010)) << model;
    EXPECT_LE(changes[0].at - ended, ascii ? microseconds(1060) : microseconds(4030)) << model;
  }
}

TEST(SilenceAfterRequest, AFrameThatBeginsWithAValidFrameIsTreatedAsOneFrame) {
  ModuleBench bench("EX9042D-M");
  const Bytes beginning = with_crc(kOutput0On);
  Bytes longer = beginning;
  longer.insert(longer.end(), {0x00, 0x00});
  longer = with_crc(longer);
  EXPECT_EQ(bench.ask(Bytes(longer.begin(), longer.end() - 2)), (Bytes{0x01, 0x85, 0x03}));
  EXPECT_EQ(bench.module().outputs(), 0U);
}

TEST(SilenceAfterRequest, AFrameWithAnExtraByteAfterItsCrcIsNotExecuted) {
  ModuleBench bench("EX9042D-M");
  Bytes spoiled = with_crc(kOutput0On);
  spoiled.push_back(0x55);
  bench.forget_heard();
  bench.send(spoiled);
  bench.run(kLong);
  EXPECT_EQ(bench.heard_text(), "");
  EXPECT_EQ(bench.module().outputs(), 0U);
  EXPECT_EQ(bench.ask(kReadOutputs), (Bytes{0x01, 0x01, 0x01, 0x00}));
  EXPECT_EQ(bench.module().outputs(), 0U) << "the damaged frame must not be executed after the next frame";
}

TEST(SilenceAfterRequest, TheInitSwitchIsEvaluatedAtTheEndOfTheSilence) {
  // At 1200 baud the turn-around takes 8.3 ms. INIT* changes so early that its debounce time of 10 ms
  // ends in the middle of the turn-around.
  constexpr microseconds kCharacter{10'000'000 / 1200};
  constexpr milliseconds kMovedBeforeTheEnd{6};
  // The command sets another baud rate. Outside INIT mode, this is permitted only while INIT* is asserted.
  const std::string command = "%0101400400\r";
  for (const bool asserted : {false, true}) {
    ModuleBench bench("EX9042D,baud=1200");
    bench.module().set_init(asserted);
    bench.run(kLong);
    const VirtualTime ends = bench.now() + static_cast<std::int64_t>(command.size()) * kCharacter;
    bench.line().master().send(reinterpret_cast<const std::uint8_t*>(command.data()), command.size());
    bench.line().wires().run_until(ends - kMovedBeforeTheEnd);
    bench.module().set_init(!asserted);
    bench.forget_heard();
    bench.line().wires().run_until(ends + milliseconds(200));
    EXPECT_EQ(bench.heard_text(), asserted ? "?01\r" : "!01\r");
  }
}

TEST(SilenceAfterRequest, TheBusMessageCountIncludesTheRequestThatReadsIt) {
  ModuleBench bench("EX9052D-M");
  EXPECT_EQ(bench.ask(kBusMessages), (Bytes{0x01, 0x08, 0x00, 0x0B, 0x00, 0x01}));
  // The count includes the request itself even if an input changes during the silence after the request.
  EXPECT_EQ(answer(bench, kBusMessages, [&] { bench.module().pulse_input(0, 1); }),
            with_crc({0x01, 0x08, 0x00, 0x0B, 0x00, 0x02}));
  EXPECT_EQ(bench.ask(kBusMessages), (Bytes{0x01, 0x08, 0x00, 0x0B, 0x00, 0x03}));
}

TEST(SilenceAfterRequest, ASettingIsStoredOnlyOnceEvenIfAnInputChangesDuringTheSilence) {
  ModuleBench bench("EX9052D");
  EXPECT_EQ(answer(bench, "~01ONEW", [&] { bench.module().pulse_input(0, 1); }), "!01\r");
  EXPECT_EQ(bench.module().memory().writes(), 1U);
  EXPECT_EQ(bench.ask("$01M"), "!01NEW");
}

}  // namespace
}  // namespace ex9000::sim
