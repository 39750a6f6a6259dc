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
                           "wrong-rate 1200", "gone", "power-cut", "hang"}) {
    EXPECT_EQ(parse_fault(text, 3).module, 3U);
  }
}

TEST(Fault, LostReplyAffectsAllModulesPermanentlyByDefault) {
  const Fault fault = parse_fault("lost-reply");
  EXPECT_FALSE(fault.module);
  EXPECT_EQ(fault.schedule.when, When::Always);
  EXPECT_FALSE(fault.schedule.lasts);
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

TEST(FaultSchedule, AScheduleWithAtHasATimeAndAnOptionalDuration) {
  const Schedule schedule = parse_fault("gone at 12.5s").schedule;
  EXPECT_EQ(schedule.when, When::At);
  EXPECT_EQ(schedule.time, 12'500ms);
  EXPECT_FALSE(schedule.lasts);
}

TEST(FaultSchedule, AScheduleWithEveryHasAPeriodAndAnOptionalDuration) {
  const Schedule schedule = parse_fault("foreign-traffic 00 every 5s").schedule;
  EXPECT_EQ(schedule.when, When::EveryTime);
  EXPECT_EQ(schedule.time, 5s);
  EXPECT_EQ(parse_fault("gone every 5s for 4s").schedule.lasts, 4s);
}

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

TEST(FaultSchedule, AScheduleWithAfterWritesHasACount) {
  EXPECT_EQ(parse_fault("power-cut after 3 writes").schedule.when, When::AfterWrites);
  EXPECT_EQ(parse_fault("power-cut after 3 writes").schedule.count, 3U);
  EXPECT_EQ(parse_fault("power-cut after 1 write").schedule.count, 1U);
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

struct Wrong {
  const char* text;
  const char* names;
  const char* mend;
};

class WrongFault : public testing::TestWithParam<Wrong> {};

TEST_P(WrongFault, IsRefusedWithAOneLineMessageThatNamesTheErrorAndTheRemedy) {
  const std::string why = why_not(GetParam().text);
  EXPECT_NE(why.find(GetParam().names), std::string::npos) << why;
  EXPECT_NE(why.find(GetParam().mend), std::string::npos) << why;
  EXPECT_EQ(why.find('\n'), std::string::npos) << why;
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, WrongFault,
    testing::Values(Wrong{"", "ends too early", "expected one of bit-errors"},
                    Wrong{"  ", "ends too early", "lost-reply"},
                    Wrong{"lost", "'lost' is not a fault", "expected one of bit-errors"},
                    Wrong{"Gone", "'Gone'", "gone"},
                    Wrong{"bit-errors", "bit-errors: ends too early", "expected P after 'bit-errors'"},
                    Wrong{"late-reply", "late-reply: ends too early", "expected TIME after 'late-reply'"},
                    Wrong{"wrong-rate", "wrong-rate: ends too early", "expected RATE after 'wrong-rate'"},
                    Wrong{"foreign-traffic", "foreign-traffic: ends too early",
                          "expected HEX after 'foreign-traffic'"}));

INSTANTIATE_TEST_SUITE_P(
    Values, WrongFault,
    testing::Values(Wrong{"bit-errors 0", "'0': expected a probability", "0.01"},
                    Wrong{"bit-errors 1.1", "'1.1'", "1e-4"}, Wrong{"bit-errors -0.1", "'-0.1'", "0.01"},
                    Wrong{"bit-errors 1%", "'1%'", "0.01"}, Wrong{"bit-errors nan", "'nan'", "0.01"},
                    Wrong{"bit-errors 1e-400", "'1e-400'", "0.01"},
                    Wrong{"late-reply 50", "'50': expected a duration", "50ms"},
                    Wrong{"late-driver -1ms", "'-1ms'", "50ms"},
                    Wrong{"echo 1us", "'1us'", "a duration of at least 1ms"}, Wrong{"echo 0s", "'0s'", "1ms"},
                    Wrong{"exception 123", "'123'", "one or two hex digits"},
                    Wrong{"wrong-unit G1", "'G1'", "one or two hex digits"},
                    Wrong{"wrong-rate 300", "'300'", "1200"}, Wrong{"wrong-rate 9600x", "'9600x'", "9600"},
                    Wrong{"foreign-traffic 5", "'5': expected", "pairs of hex digits"},
                    Wrong{"foreign-traffic 05G1", "'05G1'", "pairs"},
                    Wrong{"foreign-traffic 0x05", "'0x05'", "pairs"},
                    Wrong{"gone 2s", "'2s' is not a schedule", "'for 2s'"},
                    Wrong{"bit-errors 1e-4 1e-4", "'1e-4' is not a schedule", "at 12.5s"}));

INSTANTIATE_TEST_SUITE_P(
    Schedules, WrongFault,
    testing::Values(Wrong{"gone soon", "'soon' is not a schedule", "after 3 writes"},
                    Wrong{"gone at", "ends too early", "expected a time after 'at'"},
                    Wrong{"gone at noon", "'noon': expected a duration", "12.5s"},
                    Wrong{"gone for", "ends too early", "expected a duration after 'for'"},
                    Wrong{"gone every", "ends too early", "expected 'reply', '10th reply' or a duration"},
                    Wrong{"lost-reply every 0th reply", "'0th'", "12.5s"},
                    Wrong{"lost-reply every 10 reply", "'10': expected a duration", "12.5s"},
                    Wrong{"lost-reply every 10th", "ends too early", "expected 'reply'"},
                    Wrong{"lost-reply every 10th time", "'time'", "expected 'reply'"},
                    Wrong{"lost-reply with", "ends too early", "expected 'probability'"},
                    Wrong{"lost-reply with luck 1", "'luck'", "'probability'"},
                    Wrong{"lost-reply with probability", "ends too early",
                          "expected a number after 'with probability'"},
                    Wrong{"lost-reply with probability 2", "'2': expected a probability", "0.01"},
                    Wrong{"power-cut after", "ends too early", "expected a count after 'after'"},
                    Wrong{"power-cut after 0 writes", "'0'", "a whole number from 1 to 999999999"},
                    Wrong{"power-cut after two writes", "'two'", "a whole number from 1 to 999999999"},
                    Wrong{"power-cut after 3", "ends too early", "expected 'writes'"},
                    Wrong{"power-cut after 3 write", "'write'", "'writes'"},
                    Wrong{"power-cut after 1 writes", "'writes'", "'write'"},
                    Wrong{"power-cut after 3 reads", "'reads'", "'writes'"}));

INSTANTIATE_TEST_SUITE_P(
    Meaningless, WrongFault,
    testing::Values(
        Wrong{"gone at 1s at 2s", "'at': the fault already has a schedule", "leave out one schedule"},
        Wrong{"gone at 1s every reply", "'every': the fault already has a schedule",
              "leave out one schedule"},
        Wrong{"gone for 1s for 2s", "'for' is given twice", "leave out one of them"},
        Wrong{"gone every 5s", "has no end", "add 'for TIME'"},
        Wrong{"bit-errors 0.1 every 5s", "has no end", "add 'for TIME'"},
        Wrong{"gone every 5s for 5s", "lasts 5s, which is not shorter than the period", "a shorter time"},
        Wrong{"power-cut every 1s", "lasts 1s, which is not shorter", "a shorter time after 'for'"},
        Wrong{"gone every 10th reply", "has no end", "add 'for TIME'"},
        Wrong{"wrong-rate 1200 with probability 0.5", "has no end", "add 'for TIME'"},
        Wrong{"bit-errors 0.1 every 10th reply", "does not depend on replies", "'at 5s for 1s'"},
        Wrong{"echo 5ms with probability 0.5 for 1s", "does not depend on replies", "'at 5s for 1s'"},
        Wrong{"foreign-traffic 00 every reply", "does not depend on replies", "'at 5s for 1s'"},
        Wrong{"hang for 1s", "'for': this fault has no duration", "leave out 'for'"},
        Wrong{"foreign-traffic 00 for 1s", "'for': this fault has no duration", "leave out 'for'"},
        Wrong{"hang every 0s", "'every 0s'", "a period of at least 1ms"},
        Wrong{"hang every 999us", "'every 999us': expected", "a period of at least 1ms"}));

}  // namespace
}  // namespace ex9000::sim
