// Tests that the face of a module contains the part of its state that the page shows, and that reading it
// does not change the module. Also tests the names of a module's terminals.
#include "sim/front_ends/panel/face.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;

Message face_of(ModuleBench& bench) { return face_of(bench.module(), bench.now()); }

/// In 0.1 s.
unsigned timer(ModuleBench& bench, unsigned channel) { return face_of(bench)["plate"]["timers"][channel]; }

TEST(Face, ShowsTheActiveSettingsAndTheLed) {
  ModuleBench bench("EX9042D@2A,baud=19200,format=8E1,checksum=on,name=PUMPS");
  EXPECT_EQ(face_of(bench)["plate"], Message::parse(R"({
    "switch": true, "powered": true, "init": false, "listening": true, "initMode": false, "address": 42,
    "serialNumber": "00000000", "baud": 19200, "format": "8E1", "protocol": "ascii", "checksum": true,
    "led": "on", "outputs": 0, "inputs": 0, "timers": [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0], "resets": 0})"));
  EXPECT_EQ(face_of(bench)["stored"]["settings"]["name"], "PUMPS");
}

TEST(Face, ShowsOutputsInputsCountersAndLatches) {
  ModuleBench bench("EX9055D");
  ASSERT_EQ(bench.ask("@0105"), ">");
  bench.module().set_input(1, true);
  bench.module().pulse_input(7, 3);
  bench.run(milliseconds(1));
  const Message face = face_of(bench);
  EXPECT_EQ(face["plate"]["outputs"], 0x05);
  EXPECT_EQ(face["plate"]["inputs"], 0x02);
  EXPECT_EQ(face["records"]["high"], 0x82);
  EXPECT_EQ(face["records"]["low"], 0x80);
  EXPECT_EQ(face["records"]["counters"], Message({0, 0, 0, 0, 0, 0, 0, 3}));
}

TEST(Face, ShowsTheRemainingTimeOfATimedOutput) {
  ModuleBench bench("EX9055D");
  ASSERT_EQ(bench.ask("~01X02800064"), "!01");  // output 0 for 10 s
  EXPECT_GT(timer(bench, 0), 90U);
  ASSERT_EQ(bench.ask("~01X02820064"), "!01");  // output 2 for 10 s
  const unsigned left = timer(bench, 2);
  EXPECT_GT(left, 90U);
  bench.run(milliseconds(1000));
  EXPECT_EQ(timer(bench, 2), left - 10);
  EXPECT_EQ(timer(bench, 1), 0U);
  bench.run(milliseconds(10'000));
  EXPECT_EQ(timer(bench, 2), 0U);
}

TEST(Face, WithoutPowerShowsSwitchesInputsAndStoredSettingsButNoFirmwareState) {
  ModuleBench bench("EX9055D@07");
  ASSERT_EQ(bench.ask("@0705"), ">");
  bench.module().set_input(0, true);
  bench.module().set_init(true);
  bench.module().power(false);
  const Message face = face_of(bench);
  // The level at the terminal does not depend on the supply.
  EXPECT_EQ(face["plate"], Message::parse(R"({
    "switch": false, "powered": false, "init": true, "listening": false, "led": "off", "outputs": 0,
    "inputs": 1, "timers": [0, 0, 0, 0, 0, 0, 0, 0], "resets": 0})"));
  EXPECT_EQ(face["records"],
            Message::parse(R"({"high": 0, "low": 0, "counters": [0, 0, 0, 0, 0, 0, 0, 0]})"));
  EXPECT_EQ(face["hostWatchdog"], Message::parse(R"({
    "enabled": false, "timedOut": false, "timeout": 0, "expires": null, "resetStatus": false})"));
  EXPECT_EQ(face["stored"]["settings"]["address"], 0x07);
}

TEST(Face, ShowsInitModeOnlyAfterAReset) {
  ModuleBench bench("EX9042D-M@2A");
  bench.module().set_init(true);
  bench.run(milliseconds(100));
  EXPECT_EQ(face_of(bench)["plate"]["init"], true);
  EXPECT_EQ(face_of(bench)["plate"]["initMode"], false);
  bench.power_cycle();
  EXPECT_EQ(face_of(bench)["plate"]["initMode"], true);
  EXPECT_EQ(face_of(bench)["plate"]["address"], 0x00);
}

TEST(Face, ShowsWhenTheHostWatchdogExpiresAndThatItHasExpired) {
  ModuleBench bench("EX9043D");
  ASSERT_EQ(bench.ask("@010002"), ">");
  ASSERT_EQ(bench.ask("~015S"), "!01");
  ASSERT_EQ(bench.ask("@010001"), ">");
  EXPECT_TRUE(face_of(bench)["hostWatchdog"]["expires"].is_null());
  ASSERT_EQ(bench.ask("~01310A"), "!01");
  const Message runs = face_of(bench)["hostWatchdog"];
  EXPECT_EQ(runs["enabled"], true);
  EXPECT_EQ(runs["timeout"], 10);
  const std::chrono::microseconds expires(runs["expires"].get<std::int64_t>());
  EXPECT_GT(expires, bench.now());
  bench.run(milliseconds(100));
  EXPECT_EQ(face_of(bench)["hostWatchdog"], runs);  // `expires` is the time of expiry, not the remaining time
  bench.line().wires().run_until(expires - milliseconds(1));
  EXPECT_EQ(face_of(bench)["hostWatchdog"]["timedOut"], false);
  bench.run(milliseconds(2));
  const Message expired = face_of(bench);
  EXPECT_EQ(expired["hostWatchdog"]["timedOut"], true);
  EXPECT_TRUE(expired["hostWatchdog"]["expires"].is_null());
  EXPECT_EQ(expired["plate"]["led"], "flashing");
  EXPECT_EQ(expired["plate"]["outputs"], 0x02);
}

TEST(Face, ShowsTheCurrentCopyOfTheSettings) {
  ModuleBench bench("EX9042D");
  const Message factory = face_of(bench)["stored"];
  EXPECT_EQ(factory["blank"], true);
  EXPECT_TRUE(factory["current"].is_null());
  EXPECT_EQ(factory["settings"], Message::parse(R"({
    "address": 1, "baud": 9600, "format": "8N1", "protocol": "ascii", "checksum": false, "edge": "falling",
    "name": "9042D", "powerOn": 0, "safe": 0, "watchdog": false, "timeout": 255, "timedOut": false,
    "responseDelay": 0, "fedByRequests": false, "inverted": 0,
    "filters": [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]})"));
  for (const std::string name : {"ONE", "TWO", "THREE"}) {
    ASSERT_EQ(bench.ask("~01O" + name), "!01");
    const Message stored = face_of(bench)["stored"];
    EXPECT_EQ(stored["blank"], false);
    EXPECT_FALSE(stored["current"].is_null());
    EXPECT_EQ(stored["settings"]["name"], name);
  }
}

TEST(Face, IgnoresADamagedCopyOfTheSettings) {
  ModuleBench bench("EX9042D");
  ASSERT_EQ(bench.ask("~01OONE"), "!01");
  ASSERT_EQ(bench.ask("~01OTWO"), "!01");
  const std::size_t current = face_of(bench)["stored"]["current"];
  bench.module().memory().contents()[hal::kPlaces[current]] ^= 1U;
  const Message stored = face_of(bench)["stored"];
  EXPECT_TRUE(stored["copies"][current]["sequence"].is_null());
  EXPECT_EQ(stored["current"], 1 - current);
  EXPECT_EQ(stored["settings"]["name"], "ONE");
}

TEST(Face, TheLedShowsUnreadableSettings) {
  ModuleBench bench("EX9042D");
  bench.module().memory().contents()[hal::kPlaces[0]] = 0;
  bench.module().memory().contents()[hal::kPlaces[1]] = 0;
  bench.power_cycle();
  EXPECT_EQ(face_of(bench)["plate"]["led"], "flashing: settings unreadable");
  EXPECT_TRUE(face_of(bench)["stored"]["current"].is_null());
}

TEST(Face, ReadingAFaceDoesNotChangeTheModule) {
  ModuleBench looked("EX9055D");
  ModuleBench left("EX9055D");
  for (int i = 0; i < 200; ++i) {
    for (ModuleBench* bench : {&looked, &left}) {
      bench->send(i % 2 == 0 ? "@01\r" : "~013105\r");
      bench->module().set_input(3, i % 3 == 0);
      bench->run(milliseconds(7 * (i % 5)));
    }
    static_cast<void>(face_of(looked));
  }
  EXPECT_EQ(looked.heard_text(), left.heard_text());
  EXPECT_EQ(looked.module().memory().contents(), left.module().memory().contents());
  EXPECT_EQ(looked.line().wires().next(), left.line().wires().next());
  EXPECT_EQ(looked.line().faults_so_far(), nullptr);
}

TEST(Terminals, RelaysAreNumberedFromOneAndOpenCollectorsFromZero) {
  for (const Model& model : kModels) {
    const bool relays = model.description.find("relay") != std::string_view::npos ||
                        model.description.find("PhotoMOS") != std::string_view::npos;
    if (model.has_outputs()) {
      EXPECT_EQ(plate_layout(model)["outputs"][0], relays ? "RL1" : "DO0") << model.designation;
    }
  }
  EXPECT_EQ(plate_layout(*find_model("EX9068D-M"))["outputs"][7], "RL8");
  EXPECT_EQ(plate_layout(*find_model("EX9042D-M"))["outputs"][12], "DO12");
  EXPECT_EQ(plate_layout(*find_model("EX9052D-M"))["inputs"][7], "DI7");
}

}  // namespace
}  // namespace ex9000::sim
