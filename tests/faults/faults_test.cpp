// Faults on a line, in virtual time: what a master hears of each, and when it strikes.
#include "sim/faults/faults.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/faults/fault_bench.hpp"
#include "tests/faults/refusal.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;
using namespace std::string_literals;

const std::string kName = "!019042D";

std::vector<std::string> two() { return {"EX9042D@01", "EX9052D@02"}; }

/// When each byte that is none of the master's or of the only module's began, and its value.
std::vector<std::pair<VirtualTime, int>> of_others(FaultBench& bench) {
  std::vector<std::pair<VirtualTime, int>> bytes;
  for (const BusRecorder::Byte& byte : bench.recorder().bytes) {
    if (byte.station > bench.line().size()) {
      bytes.emplace_back(byte.start, byte.byte);
    }
  }
  return bytes;
}

/// When the module at `position` has begun to answer.
std::vector<VirtualTime> answers_of(FaultBench& bench, std::size_t position) {
  std::vector<VirtualTime> begun;
  for (const BusRecorder::Driver& driver : bench.recorder().drivers) {
    if (driver.on && driver.station == position) {
      begun.push_back(driver.at);
    }
  }
  return begun;
}

/// Which of so many requests are answered: `.` those that are not.
std::string answered(FaultBench& bench, unsigned requests, const std::string& address = "01") {
  std::string which;
  for (unsigned i = 0; i < requests; ++i) {
    const std::string reply = bench.ask("$" + address + "M");
    which += reply.empty() ? '.' : reply.rfind("!" + address, 0) == 0 && !bench.garbled() ? 'x' : '?';
  }
  return which;
}

// --- the line ---

TEST(BitErrors, OfAllBitsMakeTheLineUnreadable) {
  FaultBench bench;
  const std::size_t fault = bench.add("bit-errors 1");
  EXPECT_NE(bench.ask("@010001"), ">");
  EXPECT_EQ(bench.at(1).outputs(), 0);
  EXPECT_TRUE(bench.faults().remove(fault));
  bench.send("\r");  // whatever has begun is over
  EXPECT_EQ(bench.ask("@010001"), ">");
}

TEST(BitErrors, AreAsManyAsTheirProbabilitySays) {
  FaultBench bench;
  const double probability = 1e-3;
  bench.add("bit-errors 1e-3");
  constexpr int kRequests = 2000;
  int whole = 0;
  for (int i = 0; i < kRequests; ++i) {
    whole += bench.ask("$01M") == kName && !bench.garbled() ? 1 : 0;
    bench.send("\r");  // whatever has begun is over
  }
  // "$01M\r" and "!019042D\r", ten bits a character.
  const double expected = std::pow(1 - probability, 10 * (5 + 9));
  const double deviation = std::sqrt(expected * (1 - expected) / kRequests);
  EXPECT_NEAR(whole / double{kRequests}, expected, 4 * deviation);
}

TEST(LostBytes, AreNotHeardByAnybody) {
  FaultBench bench;
  bench.add("lost-bytes 1");
  EXPECT_EQ(bench.ask("@010001"), "");
  EXPECT_EQ(bench.at(1).outputs(), 0);
  EXPECT_FALSE(bench.garbled());
}

TEST(LostBytes, AreAsManyAsTheirProbabilitySays) {
  FaultBench bench;
  bench.add("lost-bytes 0.01");
  constexpr int kRequests = 2000;
  int unheard = 0;
  for (int i = 0; i < kRequests; ++i) {
    unheard += bench.ask("$01M").empty() ? 1 : 0;
    bench.send("\r");  // whatever has begun is over
  }
  const double expected = 1 - std::pow(0.99, 5);  // "$01M\r"
  const double deviation = std::sqrt(expected * (1 - expected) / kRequests);
  EXPECT_NEAR(unheard / double{kRequests}, expected, 4 * deviation);
}

TEST(InsertedBytes, ComeRightBehindEachByte) {
  FaultBench bench;
  bench.add("inserted-bytes 1");
  bench.send("\r");
  const VirtualTime sent = bench.now();
  bench.run(10ms);
  ASSERT_EQ(of_others(bench).size(), 1U);
  EXPECT_EQ(of_others(bench)[0].first, sent);
  EXPECT_EQ(bench.heard().size(), 1U);
  EXPECT_FALSE(bench.garbled());
}

TEST(StrayZeros, ComeRightBehindEachByte) {
  FaultBench bench;
  bench.add("stray-zeros 1");
  bench.ask("");
  EXPECT_EQ(bench.heard(), "\0"s);
}

TEST(StrayZeros, BehindSomeBytesLeaveTheOthersAlone) {
  FaultBench bench;
  bench.add("stray-zeros 0.01");
  const std::string which = answered(bench, 200);
  EXPECT_GT(std::count(which.begin(), which.end(), 'x'), 120);
  EXPECT_LT(std::count(which.begin(), which.end(), 'x'), 195);
}

TEST(EchoFault, SaysAgainWhatWasSaidAfterItsSilence) {
  FaultBench bench;
  bench.add("echo 5ms");
  EXPECT_EQ(bench.ask("$05M"), "$05M");  // for a module that is not here
  const VirtualTime request_over = bench.recorder().bytes[4].end;
  EXPECT_EQ(of_others(bench)[0].first, request_over + 5ms);
}

TEST(EchoFault, FollowsTheLinesRate) {
  FaultBench bench;
  bench.add("echo 5ms");
  bench.line().master().set_baud(19200);
  EXPECT_EQ(bench.ask("$05M"), "$05M");
}

TEST(EchoFault, LeavesOffWhenItIsRemoved) {
  FaultBench bench;
  const std::size_t fault = bench.add("echo 5ms");
  EXPECT_TRUE(bench.faults().remove(fault));
  EXPECT_EQ(bench.ask("$05M"), "");
}

TEST(ForeignTraffic, IsSaidFromItsMomentOnAtTheLinesRate) {
  FaultBench bench;
  bench.add("foreign-traffic 0501000000083C48 at 1s");
  bench.run_until(2s);
  EXPECT_EQ(bench.heard(), "\x05\x01\0\0\0\x08\x3C\x48"s);
  const auto said = of_others(bench);
  ASSERT_EQ(said.size(), 8U);
  EXPECT_EQ(said[0].first, 1s);
  EXPECT_EQ(said[7].first - said[0].first, bench.line().master().takes(7));
}

TEST(ForeignTraffic, CollidesWithWhoeverTalks) {
  FaultBench bench;
  bench.run_until(1s);
  bench.add("foreign-traffic 0000000000");
  EXPECT_NE(bench.ask("$01M"), kName);
}

TEST(ForeignTraffic, MoreOfItThanALineCarriesDoesNotPileUp) {
  FaultBench bench;
  const std::size_t fault = bench.add("foreign-traffic 00112233445566778899 every 1ms");
  bench.run(30s);
  EXPECT_TRUE(bench.faults().remove(fault));
  bench.run(3s);
  EXPECT_EQ(bench.ask("$01M"), kName);
}

// --- replies ---

TEST(LostReply, IsNotHeardAndTheCommandIsCarriedOut) {
  FaultBench bench;
  bench.add("lost-reply");
  EXPECT_EQ(bench.ask("@010001"), "");
  EXPECT_EQ(bench.at(1).outputs(), 1);
  EXPECT_EQ(answers_of(bench, 1).size(), 0U);
}

TEST(LateReply, BeginsLaterByThatAndIsWhole) {
  FaultBench punctual;
  EXPECT_EQ(punctual.ask("$01M"), kName);
  FaultBench bench;
  bench.add("late-reply 50ms");
  EXPECT_EQ(bench.ask("$01M", 100ms), kName);
  EXPECT_EQ(answers_of(bench, 1)[0], answers_of(punctual, 1)[0] + 50ms);
}

TEST(LateReply, MayComeBehindTheNextRequestAndThenTheNextReplyFollowsIt) {
  FaultBench bench;
  bench.add("late-reply 50ms every 2nd reply");
  EXPECT_EQ(bench.ask("$01M"), kName);
  EXPECT_EQ(bench.ask("$01M", 20ms), "");  // gives up too early,
  EXPECT_EQ(bench.ask("$012", 1ms), "");   // asks for something else,
  bench.run(100ms);
  EXPECT_EQ(bench.heard(), kName + "\r!01400600\r");  // and takes the one for the other
  EXPECT_FALSE(bench.garbled());
}

TEST(LateReply, OfEveryReplyKeepsTheirOrder) {
  FaultBench bench;
  bench.add("late-reply 200ms");
  bench.forget();
  for (const char* command : {"$01M\r", "$012\r", "@01\r", "$01F\r"}) {
    bench.send(command);
    bench.run(25ms);
  }
  bench.run(500ms);
  EXPECT_EQ(bench.heard(), kName + "\r!01400600\r>0000\r!01D01.00\r");
}

TEST(LateReply, IsNeverSentOnceTheSupplyHasFailed) {
  FaultBench bench;
  bench.add("late-reply 200ms");
  EXPECT_EQ(bench.ask("$01M"), "");
  bench.at(1).power(false);
  bench.at(1).power(true);
  bench.forget();
  bench.run(1s);
  EXPECT_EQ(bench.heard(), "");
}

TEST(LateReply, IsHitByTheNoiseThatIsOfItAndNothingElseIs) {
  FaultBench bench;
  bench.add("late-reply 50ms every 2nd reply");
  bench.add("bit-errors 1 every 2nd reply");
  EXPECT_EQ(bench.ask("$01M"), kName);
  EXPECT_EQ(bench.ask("$01M", 20ms), "");  // gives up too early, and asks on:
  bench.send("@010001\r");                 // that is not hit
  bench.run(200ms);
  EXPECT_EQ(bench.at(1).outputs(), 1);
  EXPECT_EQ(bench.heard().find(kName), std::string::npos);
  EXPECT_TRUE(bench.garbled());
}

TEST(LateReply, ThatIsLostTakesItsNoiseWithIt) {
  FaultBench bench;
  bench.add("lost-reply every 2nd reply");
  bench.add("bit-errors 1 every 2nd reply");
  bench.ask("$01M");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_EQ(bench.ask("$01M"), kName);
}

TEST(LateDriver, HoldsTheLineAndWhatIsSaidThenIsLost) {
  FaultBench bench;
  bench.add("late-driver 20ms");
  EXPECT_EQ(bench.ask("$01M", 15ms), kName);
  EXPECT_NE(bench.ask("$01M", 15ms), kName);  // begins within the 20 ms
  bench.run(100ms);
  EXPECT_EQ(bench.ask("$01M", 100ms), kName);
  const BusRecorder::Driver off = bench.recorder().drivers.back();
  EXPECT_EQ(off.station, 1U);
  EXPECT_GE(off.at - bench.recorder().bytes.back().end, 20ms);
  EXPECT_LE(off.at - bench.recorder().bytes.back().end, 20ms + 3us);
}

// --- modules ---

TEST(WrongRate, IsThatAtWhichItListensAndSends) {
  FaultBench bench(two());
  const std::size_t fault = bench.add("wrong-rate 19200", 1);
  EXPECT_NE(bench.ask("$01M"), kName);
  EXPECT_EQ(bench.ask("$02M"), "!029052");
  bench.line().master().set_baud(19200);
  EXPECT_EQ(bench.ask("$01M"), kName);
  bench.line().master().set_baud(9600);
  EXPECT_TRUE(bench.faults().remove(fault));
  EXPECT_EQ(bench.ask("$01M"), kName);
}

TEST(Gone, TakesTheSupplyAndGivesItBack) {
  FaultBench bench;
  bench.ask("@010A05");
  bench.ask("$015");
  const std::size_t fault = bench.add("gone");
  EXPECT_FALSE(bench.at(1).powered());
  EXPECT_EQ(bench.at(1).outputs(), 0);
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_TRUE(bench.faults().remove(fault));
  bench.run(100ms);
  EXPECT_EQ(bench.ask("$015"), "!011");
}

TEST(Gone, InTheMiddleOfAReplyCutsIt) {
  FaultBench bench;
  bench.forget();
  bench.send("$01M\r");
  bench.run(5ms);
  bench.add("gone");
  bench.run(100ms);
  EXPECT_LT(bench.heard().size(), 6U);
  EXPECT_FALSE(bench.recorder().drivers.back().on);
}

TEST(Gone, DoesNotSwitchAModuleOnThatSomebodyElseHasSwitchedOff) {
  for (const bool before : {true, false}) {
    FaultBench bench;
    if (before) {
      bench.at(1).power(false);
    }
    bench.add("gone for 2s");
    bench.run(1s);
    bench.at(1).power(false);
    bench.run(2s);
    EXPECT_FALSE(bench.at(1).powered()) << before;
    bench.at(1).power(true);
    EXPECT_TRUE(bench.at(1).powered());
  }
}

TEST(Gone, LastsAlsoWhereSomebodySwitchesTheModuleOn) {
  FaultBench bench;
  bench.add("gone for 2s");
  bench.run(1s);
  bench.at(1).power(true);
  EXPECT_FALSE(bench.at(1).powered());
  bench.run(1s);
  EXPECT_TRUE(bench.at(1).powered());
}

TEST(PowerCut, LastsASecondUnlessTold) {
  for (const auto& [text, lasts] : {std::pair("power-cut", 1000ms), std::pair("power-cut for 30ms", 30ms)}) {
    FaultBench bench;
    bench.add(text);
    const VirtualTime cut = bench.now();
    bench.run_until(cut + lasts - 1ns);
    EXPECT_FALSE(bench.at(1).powered()) << text;
    bench.run_until(cut + lasts);
    EXPECT_TRUE(bench.at(1).powered()) << text;
    bench.run(100ms);
    EXPECT_EQ(bench.ask("$015"), "!011");
  }
}

TEST(Hang, SilencesAModuleUntilItsWatchdogResetsIt) {
  FaultBench bench;
  bench.add("hang at 1s");
  bench.run_until(1s - 1ns);
  EXPECT_EQ(bench.at(1).watchdog_resets(), 0U);
  bench.run_until(1s);
  EXPECT_EQ(bench.ask("$01M"), "");
  bench.run_until(1s + 1600ms);
  EXPECT_EQ(bench.at(1).watchdog_resets(), 1U);
  bench.run(100ms);
  EXPECT_EQ(bench.ask("$01M"), kName);
  bench.run(10s);
  EXPECT_EQ(bench.at(1).watchdog_resets(), 1U);
}

TEST(Hang, OfEveryReplyLetsThatReplyOut) {
  FaultBench bench;
  bench.add("hang every 2nd reply");
  EXPECT_EQ(bench.ask("$01M"), kName);
  EXPECT_EQ(bench.ask("$01M"), kName);
  EXPECT_EQ(bench.ask("$01M"), "");
  bench.run(2s);
  EXPECT_EQ(bench.at(1).watchdog_resets(), 1U);
}

// --- when ---

TEST(FaultsSchedule, AlwaysBeginsAtOnceAndEndsWhenItIsTold) {
  FaultBench bench;
  bench.run_until(1s);
  bench.add("gone for 250ms");
  EXPECT_FALSE(bench.at(1).powered());
  bench.run_until(1250ms - 1ns);
  EXPECT_FALSE(bench.at(1).powered());
  bench.run_until(1250ms);
  EXPECT_TRUE(bench.at(1).powered());
  bench.run(10s);
  EXPECT_TRUE(bench.at(1).powered());
}

TEST(FaultsSchedule, AMomentIsExactAndCountsFromTheLinesBegin) {
  FaultBench bench;
  bench.add("gone at 12.5s for 2s");
  bench.run_until(12'500ms - 1ns);
  EXPECT_TRUE(bench.at(1).powered());
  bench.run_until(12'500ms);
  EXPECT_FALSE(bench.at(1).powered());
  bench.run_until(14'500ms - 1ns);
  EXPECT_FALSE(bench.at(1).powered());
  bench.run_until(14'500ms);
  EXPECT_TRUE(bench.at(1).powered());
}

TEST(FaultsSchedule, AMomentThatIsOverIsRefused) {
  FaultBench bench;
  bench.run_until(2s);
  EXPECT_EQ(refusal([&] { bench.add("gone at 1.5s"); }), "gone at 1.5s: that is over, it is 2s now");
  EXPECT_TRUE(bench.faults().told().empty());
  EXPECT_EQ(bench.add("gone at 2s"), 1U);
  EXPECT_FALSE(bench.at(1).powered());
}

TEST(FaultsSchedule, APeriodIsExactFromWhenItIsAdded) {
  FaultBench bench;
  bench.run_until(700ms);
  bench.add("foreign-traffic 55 every 5s");
  bench.run_until(26s);
  const auto said = of_others(bench);
  ASSERT_EQ(said.size(), 5U);
  for (std::size_t i = 0; i < said.size(); ++i) {
    EXPECT_EQ(said[i].first, 700ms + 5s * (i + 1));
  }
}

TEST(FaultsSchedule, WhatLastsIsOverBeforeItsPeriodIs) {
  FaultBench bench;
  bench.run_until(1s);
  bench.add("gone every 5s for 1s");
  for (int i = 1; i <= 4; ++i) {
    bench.run_until(1s + 5s * i - 1ns);
    EXPECT_TRUE(bench.at(1).powered()) << i;
    bench.run_until(1s + 5s * i + 1s - 1ns);
    EXPECT_FALSE(bench.at(1).powered()) << i;
    bench.run_until(1s + 5s * i + 1s);
    EXPECT_TRUE(bench.at(1).powered()) << i;
  }
  EXPECT_EQ(bench.faults().told()[0].strikes_so_far, 4U);
}

TEST(FaultsSchedule, OfRepliesStrikesEveryReplyOrEverySoManieth) {
  FaultBench every;
  every.add("lost-reply every reply");
  EXPECT_EQ(answered(every, 5), ".....");
  FaultBench tenth;
  tenth.add("lost-reply every 10th reply");
  EXPECT_EQ(answered(tenth, 35), "xxxxxxxxx.xxxxxxxxx.xxxxxxxxx.xxxxx");
  EXPECT_EQ(tenth.faults().told()[0].strikes_so_far, 3U);
}

TEST(FaultsSchedule, OfTheRepliesOfAllModulesCountsThemTogether) {
  FaultBench bench(two());
  bench.add("lost-reply every 3rd reply");
  EXPECT_EQ(answered(bench, 2, "01"), "xx");
  EXPECT_EQ(answered(bench, 2, "02"), ".x");
  EXPECT_EQ(answered(bench, 2, "01"), "x.");
}

TEST(FaultsSchedule, OfRepliesMayLastBeyondTheReply) {
  FaultBench bench;
  bench.add("lost-reply every 3rd reply for 100ms");
  const std::string which = answered(bench, 6);  // one takes 55 ms
  EXPECT_EQ(which.substr(0, 4), "xx..");
  EXPECT_EQ(which[5], '.');  // the sixth
}

TEST(FaultsSchedule, AProbabilityIsKeptAndASeedRepeatsIt) {
  const auto which = [](std::uint64_t seed) {
    FaultBench bench({"EX9042D@01"}, seed);
    bench.add("lost-reply with probability 0.25");
    return answered(bench, 2000);
  };
  const std::string first = which(1);
  EXPECT_EQ(which(1), first);
  EXPECT_NE(which(2), first);
  const double lost = static_cast<double>(std::count(first.begin(), first.end(), '.')) / 2000;
  EXPECT_NEAR(lost, 0.25, 4 * std::sqrt(0.25 * 0.75 / 2000));
}

TEST(FaultsSchedule, OfWritesCutsBehindTheWriteAndBeforeItsReply) {
  FaultBench bench;
  bench.add("power-cut after 3 writes");
  EXPECT_EQ(bench.ask("~01OFIRST"), "!01");
  EXPECT_EQ(bench.ask("~01OSECOND"), "!01");
  bench.ask("$01M");  // stores nothing
  EXPECT_EQ(bench.ask("~01OTHIRD"), "");
  EXPECT_FALSE(bench.at(1).powered());
  bench.run(1200ms);
  EXPECT_EQ(bench.ask("$01M"), "!01THIRD");
  EXPECT_EQ(bench.ask("~01OFOURTH"), "!01");  // once
  EXPECT_EQ(bench.ask("~01OFIFTH"), "!01");
  EXPECT_EQ(bench.ask("~01OSIXTH"), "!01");
  EXPECT_EQ(bench.faults().told()[0].strikes_so_far, 1U);
}

TEST(FaultsSchedule, OfWritesCountsThoseOfItsOwnModule) {
  FaultBench bench(two());
  bench.add("gone after 1 write for 1s", 2);
  EXPECT_EQ(bench.ask("~01OOTHER"), "!01");
  EXPECT_TRUE(bench.at(2).powered());
  EXPECT_EQ(bench.ask("~02OMINE"), "");
  EXPECT_TRUE(bench.at(1).powered());
  bench.run(1200ms);
  EXPECT_EQ(bench.ask("$02M"), "!02MINE");
}

// --- whom it befalls ---

TEST(FaultsOfAModule, LeaveTheOthersAlone) {
  for (const char* trouble : {"lost-reply", "late-reply 30ms", "late-driver 5ms", "wrong-rate 1200", "gone",
                              "power-cut", "hang", "lost-reply every reply", "late-reply 30ms every reply",
                              "gone every reply for 5s", "hang every reply", "power-cut every reply",
                              "wrong-rate 1200 every reply for 5s", "late-driver 5ms every reply"}) {
    FaultBench bench(two());
    bench.add(trouble, 1);
    bench.ask("$01M", 200ms);
    EXPECT_EQ(bench.ask("$02M"), "!029052") << trouble;
    EXPECT_EQ(bench.ask("$02M"), "!029052") << trouble;
    EXPECT_TRUE(bench.at(2).powered()) << trouble;
  }
}

TEST(FaultsOfAllModules, ThatStrikeWithAReplyBefallWhoSendsIt) {
  FaultBench bench(two());
  bench.add("gone every reply for 10s");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_FALSE(bench.at(1).powered());
  EXPECT_TRUE(bench.at(2).powered());
  const VirtualTime first = bench.now();
  bench.run(5s);
  EXPECT_EQ(bench.ask("$02M"), "");
  EXPECT_FALSE(bench.at(2).powered());
  EXPECT_FALSE(bench.at(1).powered());  // the other's strike does not end its own
  bench.run_until(first + 10s);
  EXPECT_TRUE(bench.at(1).powered());
  EXPECT_FALSE(bench.at(2).powered());
  bench.run(6s);
  EXPECT_TRUE(bench.at(2).powered());
}

TEST(FaultsOfAllModules, StrikeAllThatThereAre) {
  FaultBench bench(two());
  bench.add("gone at 1s");
  bench.run_until(1s);
  EXPECT_FALSE(bench.at(1).powered());
  EXPECT_FALSE(bench.at(2).powered());
}

TEST(FaultsOfAModule, ThatTheLineLacksAreRefused) {
  FaultBench bench(two());
  EXPECT_EQ(refusal([&] { bench.add("gone", 3); }), "gone: no module 3; this line has 1 to 2");
  EXPECT_TRUE(bench.faults().told().empty());
}

TEST(NoiseOfAReply, HitsThatReplyAndNothingElse) {
  FaultBench bench;
  bench.add("bit-errors 1 every 2nd reply");
  for (int i = 0; i < 6; ++i) {
    const std::string outputs = i % 2 == 0 ? "0001" : "0002";
    const std::string reply = bench.ask("@01" + outputs);
    EXPECT_EQ(bench.at(1).outputs(), i % 2 == 0 ? 1 : 2);  // each request was heard
    EXPECT_EQ(reply == ">", i % 2 == 0) << i;
  }
}

TEST(NoiseOfSeveralFaults, IsThatOfTheWorst) {
  FaultBench bench;
  const std::size_t worst = bench.add("lost-bytes 1");
  bench.add("lost-bytes 1e-9");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_TRUE(bench.faults().remove(worst));
  EXPECT_EQ(bench.ask("$01M"), kName);
}

// --- the list ---

TEST(FaultsList, RemovedIsOver) {
  for (const char* trouble :
       {"bit-errors 1", "lost-bytes 1", "stray-zeros 1", "inserted-bytes 1", "lost-reply", "late-reply 1s",
        "wrong-rate 1200", "gone", "power-cut for 1h", "lost-reply every reply", "gone every 10ms for 5ms"}) {
    for (const bool all : {false, true}) {
      FaultBench bench;
      const std::size_t fault = bench.add(trouble);
      EXPECT_NE(bench.ask("$01M"), kName) << trouble;
      if (all) {
        bench.faults().remove_all();
      } else {
        EXPECT_TRUE(bench.faults().remove(fault));
      }
      EXPECT_TRUE(bench.faults().told().empty());
      bench.run(2s);
      bench.send("\r");  // whatever has begun is over
      EXPECT_EQ(bench.ask("$01M"), kName) << trouble;
    }
  }
}

TEST(FaultsList, NumbersGoOnAndNoneIsGivenTwice) {
  FaultBench bench;
  EXPECT_EQ(bench.add("lost-reply at 1h"), 1U);
  EXPECT_EQ(bench.add("lost-reply at 2h"), 2U);
  EXPECT_TRUE(bench.faults().remove(1));
  EXPECT_FALSE(bench.faults().remove(1));
  EXPECT_FALSE(bench.faults().remove(0));
  EXPECT_FALSE(bench.faults().remove(3));
  EXPECT_EQ(bench.add("lost-reply at 3h"), 3U);
  bench.faults().remove_all();
  EXPECT_EQ(bench.add("lost-reply"), 4U);
}

TEST(FaultsList, TellsWhatStrikesNowAndHowOftenItHas) {
  FaultBench bench(two());
  bench.add("gone at 1s for 1s", 2);
  bench.add("lost-reply every reply", 1);
  bench.ask("$01M");
  bench.run_until(1500ms);
  const std::vector<Faults::Told> told = bench.faults().told();
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0].number, 1U);
  EXPECT_EQ(told[0].text, "gone at 1s for 1s");
  EXPECT_EQ(told[0].module, 1U);
  EXPECT_TRUE(told[0].strikes);
  EXPECT_EQ(told[0].strikes_so_far, 1U);
  EXPECT_FALSE(told[1].strikes);
  EXPECT_EQ(told[1].strikes_so_far, 1U);
  bench.run_until(2s);
  EXPECT_FALSE(bench.faults().told()[0].strikes);
}

TEST(FaultsNotice, IsGivenOfWhatComesAndGoesByItself) {
  FaultBench bench;
  bench.add("lost-reply every reply");
  bench.add("lost-bytes 1e-9");
  bench.add("gone at 1s for 1s");
  bench.add("hang at 5s");
  bench.ask("$01M");
  EXPECT_EQ(bench.notices(), std::vector<std::string>());
  bench.run_until(10s);
  EXPECT_EQ(bench.notices(),
            (std::vector<std::string>{"fault 3 strikes: gone at 1s for 1s",
                                      "fault 3 is over: gone at 1s for 1s", "fault 4 strikes: hang at 5s"}));
}

TEST(FaultsTogether, TheSameSeedAndLineGiveTheSameBytes) {
  const auto all_heard = [](std::uint64_t seed) {
    FaultBench bench(two(), seed);
    for (const char* fault : {"bit-errors 1e-3", "stray-zeros 0.01", "inserted-bytes 0.01", "lost-bytes 0.01",
                              "late-reply 7ms with probability 0.3", "lost-reply with probability 0.1",
                              "gone every 5s for 300ms", "foreign-traffic 0102 every 777ms"}) {
      bench.add(fault);
    }
    std::string heard;
    for (int i = 0; i < 100; ++i) {
      heard += bench.ask(i % 2 == 0 ? "$01M" : "$02M") + "|";
    }
    return heard;
  };
  EXPECT_EQ(all_heard(1), all_heard(1));
  EXPECT_NE(all_heard(1), all_heard(2));
}

}  // namespace
}  // namespace ex9000::sim
