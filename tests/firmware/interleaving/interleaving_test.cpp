// Tests interrupts at every point at which the main loop accesses data that it shares with interrupts.
//
// The core's own sources and hal/device.hpp run here with crossings, a clock and registers that report every
// access of the main loop (tests/support/interleaving/). The points are before and after each access. At a
// point, a test runs steps of a script. The steps cause interrupts. The class Interleaver tries many points.
// It requires that each part of the outcome also occurs in a run without steps during the turn. In such a
// run, any number of first steps come before the turn, and the other steps come after it. scenarios.cpp
// contains the scenarios of the first two tests.
//
// The interrupts and the main loop also share the following data, which is neither a WrittenByInterrupt nor a
// WrittenByMainLoop:
//  - FrameQueue::frames_: the waiting frame belongs to the main loop from the store to `completed_` until the
//    store to `dropped_`;
//  - Uart::rest_, a HandedToInterrupt: it belongs to the main loop until the store to `begun_`, then to the
//    interrupts until the store to `ended_`;
//  - the bytes of a reply, to which `rest_` refers: the main loop does not write them from the store to
//    `begun_` until the store to `ended_`;
//  - Uart::bit_ and character_: `open` writes them before the UART can cause an interrupt;
//  - Receiver::protocol_, DconAssembler::checksum_, RtuAssembler::timing_: `listen` writes them before
//    `open`;
//  - InputEdges::levels_: `begin` writes this value before interrupts are enabled;
//  - the driver's pin: the mask in the address selects the pin, so that a write needs no read.
// Only the main loop uses EventTally::collected_; the interrupt uses only `total_`.
//
// Time passes as on a line: a byte takes 87 us even if it arrives in the middle of a turn, so the steps may
// delay a turn by milliseconds.
#include <gtest/gtest.h>

#include <cstddef>
#include <random>
#include <string>

#include "tests/firmware/interleaving/interleaver.hpp"
#include "tests/firmware/interleaving/modbus_frames.hpp"
#include "tests/firmware/interleaving/scenarios.hpp"
#include "tests/firmware/interleaving/steps.hpp"

namespace ex9000::interleaving {
namespace {

TEST(Interleaving, AnInterruptAtAnyPointHasAPermittedOutcome) {
  Tried all;
  for (const Scenario& scenario : scenarios()) {
    Interleaver(scenario, all).at_every_point();
  }
  all.print();
  EXPECT_GT(all.points, 900U);
  EXPECT_GT(all.interleavings, 2000U);
}

TEST(Interleaving, InterruptsAtRandomPairsOfPointsHaveAPermittedOutcome) {
  std::mt19937 random(20261121);  // NOLINT(cert-msc51-cpp): the same pairs each time
  Tried all;
  for (const Scenario& scenario : scenarios()) {
    Interleaver(scenario, all).at_pairs(random, 200);
  }
  all.print();
  EXPECT_GT(all.interleavings, 4000U);
}

TEST(Interleaving, TheEndOfTheTurnAroundOfAFrameDoesNotCauseAnEarlyReplyToTheNextFrame) {
  // The turn-around time of a frame without a reply ends during the turn. The next frame arrives at the same
  // or a later point of this turn.
  Scenario scenario = dcon(
      "a silence, and one more frame", [](Bench& bench) { bench.bytes("#**\r"); },
      {silence, [](Bench& bench) { bench.asks("$01M\r", "!019055\r"); }}, {{"!019055\r"}, {}}, no_matter);
  Tried all;
  Interleaver(scenario, all).at_all_pairs();
  all.print();
  EXPECT_GT(all.interleavings, 200U);
}

/// Plays the turn that replies to an earlier frame, once for each point of the turn, and sends a new frame at
/// this point. If the earlier frame still waits in the queue, the new frame is lost. At all later points
/// before the reply to the earlier frame starts, the module must reply to the new frame too. After this reply
/// has started, the module must ignore the new frame.
void expect_one_more_is_kept(Scenario scenario, const std::string& request, const std::string& reply) {
  bool driving = false;
  std::size_t answered = 0;
  scenario.script = {[&](Bench& bench) {
    driving = bench.takes_bytes_for_its_echo();
    bench.asks(request, reply);
    bench.silence();
  }};
  scenario.comes_to = [&](Bench& bench) {
    answered = bench.hardware().sent.size();
    return Parts();
  };
  const int points = static_cast<int>(play(scenario, {kAfterTheTurn}).points);
  EXPECT_GT(points, 10) << scenario.name;
  bool judged = false;
  int kept = 0;
  for (int point = 0; point < points; ++point) {
    play(scenario, {point});
    judged |= answered == 2;
    kept += answered == 2 ? 1 : 0;
    EXPECT_TRUE(answered == 2 || !judged || driving) << scenario.name << ", at " << point;
    EXPECT_FALSE(answered == 2 && driving) << scenario.name << ", at " << point;
  }
  EXPECT_GT(kept, 1) << scenario.name;
}

TEST(Interleaving, AFrameIsKeptIfItArrivesAfterThePreviousFrameIsJudgedAndBeforeTheReplyStarts) {
  expect_one_more_is_kept(dcon("a frame after one that is answered", asked("$01F\r", "!01D01.00\r"), {},
                               {{"!01D01.00\r", "!019055\r"}, {"!01D01.00\r"}}, no_matter),
                          "$01M\r", "!019055\r");
  expect_one_more_is_kept(dcon("a frame after one that is carried out", asked("$015\r", "!011\r"), {},
                               {{"!011\r", "!019055\r"}, {"!011\r"}}, no_matter),
                          "$01M\r", "!019055\r");
  expect_one_more_is_kept(modbus("a Modbus frame after one that is carried out", asked(kRtuOn, kRtuOn), {},
                                 {{kRtuOn, kRtuReadOnReply}, {kRtuOn}}, no_matter),
                          kRtuRead, kRtuReadOnReply);
}

TEST(Interleaving, AFrameThatEndsDuringATurnOfTheMainLoopIsNotAnsweredTooEarly) {
  const Scenario scenario =
      dcon("a CR that is newer than the time of the turn", nothing,
           {[](Bench& bench) { bench.asks("@0105\r", ">\r"); }, silence}, {{">\r"}}, outputs_and_name);
  const int points = static_cast<int>(play(scenario, {kAfterTheTurn, kAfterTheTurn}).points);
  EXPECT_GT(points, 10);
  for (int point = kBeforeTheTurn; point < points; ++point) {
    EXPECT_NO_THROW(play(scenario, {point, kAfterTheTurn})) << point;
  }
}

TEST(Interleaving, ARequestForTheBusMessageCountIsCountedOnceIfItsSilenceEndsAtAnyPoint) {
  const std::string request = rtu({1, 0x08, 0, 0x0B, 0, 0});
  const std::string reply = rtu({1, 0x08, 0, 0x0B, 0, 1});
  const Scenario scenario = modbus(
      "a silence while bus messages are read", [=](Bench& bench) { bench.asks(request, reply); }, {silence},
      {{reply}}, outputs_and_name);
  const int points = static_cast<int>(play(scenario, {kAfterTheTurn}).points);
  EXPECT_GT(points, 10);
  for (int point = kBeforeTheTurn; point < points; ++point) {
    EXPECT_NO_THROW(play(scenario, {point})) << point;
  }
}

}  // namespace
}  // namespace ex9000::interleaving
