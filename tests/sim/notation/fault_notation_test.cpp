// Tests the syntax of faults and the texts about them.
#include "sim/notation/fault_notation.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/refusal.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;
using When = Schedule::When;

std::string why_not(const std::string& text) {
  return refusal([&] { parse_fault(text); });
}

// --- kinds of faults ---

TEST(Fault, EachKindIsParsedWithItsValueIfItHasOne) {
  EXPECT_EQ(parse_fault("bit-errors 1e-4").probability, 1e-4);
  EXPECT_EQ(parse_fault("lost-bytes 0.01").probability, 0.01);
  EXPECT_EQ(parse_fault("inserted-bytes 1").probability, 1);
  EXPECT_EQ(parse_fault("echo 2ms").time, 2ms);
  EXPECT_EQ(parse_fault("foreign-traffic 05aF00").bytes, (std::vector<std::uint8_t>{0x05, 0xAF, 0x00}));
  EXPECT_EQ(parse_fault("late-reply 50ms").time, 50ms);
  EXPECT_EQ(parse_fault("exception 0b").bytes, std::vector<std::uint8_t>{0x0B});
  EXPECT_EQ(parse_fault("wrong-unit 7").bytes, std::vector<std::uint8_t>{0x07});
  EXPECT_EQ(parse_fault("late-driver 300us").time, 300us);
  EXPECT_EQ(parse_fault("wrong-rate 19200").rate, 19200U);
}

TEST(Fault, EveryKindAffectsEitherTheLineOrAModule) {
  for (const char* text :
       {"bit-errors 1", "lost-bytes 1", "inserted-bytes 1", "echo 2ms", "foreign-traffic 00"}) {
    EXPECT_EQ(refusal([&] { parse_fault(text, 0); }),
              std::string(text) + ": concerns the line, not a module; add it as a fault of the line");
  }
  for (const char* text : {"lost-reply", "late-reply 1s", "exception 02", "wrong-unit 02", "late-driver 1s",
                           "wrong-rate 1200", "gone", "power-cut", "hang", "bad-image"}) {
    EXPECT_EQ(parse_fault(text, 3).module, 3U);
  }
}

TEST(Fault, HelpAndUsualFaultsHaveEachKindWithItsValue) {
  const std::string help = "\n" + fault_help();
  for (const char* shape : {"bit-errors P ", "echo TIME ", "foreign-traffic HEX ", "lost-reply  ",
                            "exception HH ", "wrong-rate RATE "}) {
    EXPECT_NE(help.find("\n  " + std::string(shape)), std::string::npos) << shape;
  }
  const std::vector<std::string> usual = usual_faults();
  ASSERT_EQ(usual.size(), fault_kinds().size());
  for (std::size_t i = 0; i < usual.size(); ++i) {
    const Fault fault = parse_fault(usual[i]);
    EXPECT_EQ(fault.text, usual[i]);
    EXPECT_EQ(fault.kind, &fault_kinds()[i]);
    EXPECT_NE(help.find("\n  " + std::string(fault.kind->name) + " "), std::string::npos);
  }
}

// --- schedules ---

TEST(FaultSchedule, EveryNthReplyAndAProbabilityAreReadAsSchedulesOfReplies) {
  EXPECT_EQ(parse_fault("lost-reply every reply").schedule.when, When::EveryReply);
  EXPECT_EQ(parse_fault("lost-reply every reply").schedule.count, 1U);
  for (const auto& [word, count] : std::vector<std::pair<std::string, std::uint64_t>>{
           {"1st", 1}, {"2nd", 2}, {"3rd", 3}, {"10th", 10}, {"21st", 21}, {"1000th", 1000}}) {
    const Schedule schedule = parse_fault("lost-reply every " + word + " reply").schedule;
    EXPECT_EQ(schedule.when, When::EveryReply);
    EXPECT_EQ(schedule.count, count);
    EXPECT_TRUE(schedule.of_replies());
  }
  const Schedule probable = parse_fault("lost-reply with probability 0.01").schedule;
  EXPECT_EQ(probable.when, When::Probably);
  EXPECT_EQ(probable.probability, 0.01);
  EXPECT_TRUE(probable.of_replies());
}

TEST(FaultSchedule, TheDurationMayComeBeforeOrAfterTheRestOfTheSchedule) {
  for (const char* text : {"gone at 1s for 2s", "gone for 2s at 1s"}) {
    const Schedule schedule = parse_fault(text).schedule;
    EXPECT_EQ(schedule.when, When::At);
    EXPECT_EQ(schedule.time, 1s);
    EXPECT_EQ(schedule.lasts, 2s);
  }
  EXPECT_EQ(parse_fault("lost-reply for 2s").schedule.when, When::Always);
  EXPECT_EQ(parse_fault("late-reply 1ms every 3rd reply for 2s").schedule.lasts, 2s);
}

// --- the text of a fault ---

TEST(Fault, TextAndErrorsAreReducedToOneLine) {
  EXPECT_EQ(parse_fault("  gone\n at\t1s ").text, "gone at 1s");
  EXPECT_EQ(why_not("gone\nat\n1").find('\n'), std::string::npos);
}

// --- wrong faults ---

// values_test.cpp and durations_test.cpp test which numbers, probabilities, bytes and times are refused.
TEST(Fault, AWrongFaultIsRefusedWithTheErrorAndTheRemedy) {
  struct Wrong {
    const char* text;
    const char* names;
    const char* mend;
  };
  for (const Wrong& wrong : std::vector<Wrong>{
           {"", "ends too early", "expected one of bit-errors"},
           {"lost", "'lost' is not a fault", "expected one of bit-errors"},
           {"bit-errors", "bit-errors: ends too early", "expected P after 'bit-errors'"},
           {"late-reply", "late-reply: ends too early", "expected TIME after 'late-reply'"},
           {"wrong-rate", "wrong-rate: ends too early", "expected RATE after 'wrong-rate'"},
           {"foreign-traffic", "foreign-traffic: ends too early", "expected HEX after 'foreign-traffic'"},
           {"bit-errors 0", "'0': expected a probability", "0.01"},
           {"late-reply 50", "'50': expected a duration", "50ms"},
           {"echo 1us", "'1us'", "a duration of at least 1ms"},
           {"exception 123", "'123'", "one or two hex digits"},
           {"wrong-unit G1", "'G1'", "one or two hex digits"},
           {"wrong-rate 300", "'300'", "1200"},
           {"foreign-traffic 5", "'5': expected", "pairs of hex digits"},
           {"gone 2s", "'2s' is not a schedule", "'for 2s'"},
           {"bit-errors 1e-4 1e-4", "'1e-4' is not a schedule", "at 12.5s"},
           {"gone soon", "'soon' is not a schedule", "after 3 writes"},
           {"gone at", "ends too early", "expected a time after 'at'"},
           {"gone at noon", "'noon': expected a duration", "12.5s"},
           {"gone for", "ends too early", "expected a duration after 'for'"},
           {"gone every", "ends too early", "expected 'reply', '10th reply' or a duration"},
           {"lost-reply every 0th reply", "'0th'", "12.5s"},
           {"lost-reply every 10 reply", "'10': expected a duration", "12.5s"},
           {"lost-reply every 10th", "ends too early", "expected 'reply'"},
           {"lost-reply every 10th time", "'time'", "expected 'reply'"},
           {"lost-reply with", "ends too early", "expected 'probability'"},
           {"lost-reply with luck 1", "'luck'", "'probability'"},
           {"lost-reply with probability", "ends too early", "expected a number after 'with probability'"},
           {"lost-reply with probability 2", "'2': expected a probability", "0.01"},
           {"power-cut after", "ends too early", "expected a count after 'after'"},
           {"power-cut after 0 writes", "'0'", "a whole number from 1 to 999999999"},
           {"power-cut after 3", "ends too early", "expected 'writes'"},
           {"power-cut after 3 write", "'write'", "'writes'"},
           {"power-cut after 1 writes", "'writes'", "'write'"},
           {"power-cut after 3 reads", "'reads'", "'writes'"},
           {"gone at 1s at 2s", "'at': the fault already has a schedule", "leave out one schedule"},
           {"gone at 1s every reply", "'every': the fault already has a schedule", "leave out one schedule"},
           {"gone for 1s for 2s", "'for' is given twice", "leave out one of them"},
           {"gone every 5s", "has no end", "add 'for TIME'"},
           {"bit-errors 0.1 every 5s", "has no end", "add 'for TIME'"},
           {"gone every 5s for 5s", "lasts 5s, which is not shorter than the period", "a shorter time"},
           {"power-cut every 1s", "lasts 1s, which is not shorter", "a shorter time after 'for'"},
           {"gone every 10th reply", "has no end", "add 'for TIME'"},
           {"wrong-rate 1200 with probability 0.5", "has no end", "add 'for TIME'"},
           {"bit-errors 0.1 every 10th reply", "does not depend on replies", "'at 5s for 1s'"},
           {"echo 5ms with probability 0.5 for 1s", "does not depend on replies", "'at 5s for 1s'"},
           {"foreign-traffic 00 every reply", "does not depend on replies", "'at 5s for 1s'"},
           {"hang for 1s", "'for': this fault has no duration", "leave out 'for'"},
           {"foreign-traffic 00 for 1s", "'for': this fault has no duration", "leave out 'for'"},
           {"hang every 0s", "'every 0s'", "a period of at least 1ms"},
           {"hang every 999us", "'every 999us': expected", "a period of at least 1ms"},
       }) {
    const std::string why = why_not(wrong.text);
    EXPECT_NE(why.find(wrong.names), std::string::npos) << why;
    EXPECT_NE(why.find(wrong.mend), std::string::npos) << why;
    EXPECT_EQ(why.find('\n'), std::string::npos) << why;
  }
}

}  // namespace
}  // namespace ex9000::sim
