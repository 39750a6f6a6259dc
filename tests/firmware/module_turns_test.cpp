// Tests what a turn (a pass of the main loop) does, when the next turn is due, when the module is at rest,
// and the command `~**`.
#include <gtest/gtest.h>

#include <string>

#include "firmware/dcon/dcon.hpp"
#include "firmware/module.hpp"
#include "tests/support/clock_at.hpp"
#include "tests/support/instant_memory.hpp"

namespace ex9000 {
namespace {

constexpr Duration kCharacter{1042};  // at 9600 baud
constexpr Duration kUnitOfTimeout = milliseconds(100);

class ModuleTurns : public testing::Test {
 protected:
  /// Starts the module with an erased memory, and runs it until it listens.
  ModuleTurns() {
    module_.start(0, now_);
    memory_.serve(module_, now_);
    while (!module_.listening()) {
      pass(milliseconds(1));
      step();
    }
    module_.listen(LineTiming::at(module_.baud(), module_.format()));
  }

  void step() { module_.step(false, now_); }
  void pass(Duration time) { now_ = now_ + time; }

  /// Does one memory job. Does not run the main loop (`step`) afterwards.
  void do_memory_job() {
    memory_.start(module_.memory_job(), now_);
    module_.memory_done(memory_.result());
  }

  /// Sends a command and a CR to the module. Then lets two character times pass, so that the turn-around time
  /// is over.
  void put(const std::string& command) {
    for (const char character : command + "\r") {
      pass(kCharacter);
      module_.on_byte(static_cast<std::uint8_t>(character), ByteStatus::Good, ClockAt{now_});
    }
    pass(kCharacter + kCharacter);
    module_.on_silence(now_);
  }
  std::string take_reply() {
    const Bytes reply = module_.take_reply(now_);
    return {reply.begin(), reply.end()};
  }
  /// Returns whether the next turn must follow immediately.
  bool requests_another_turn() { return module_.next_deadline().reached(now_); }

  Module module_{*find_model("EX9043D")};
  Time now_;
  InstantMemory memory_;
};

TEST_F(ModuleTurns, TheModuleIsAtRestOnlyAfterItsStartAndWithoutARequestInProgress) {
  EXPECT_TRUE(module_.at_rest());
  put("$01M");
  EXPECT_FALSE(module_.at_rest());  // the request waits
  step();
  EXPECT_FALSE(module_.at_rest());  // the reply is ready
  take_reply();
  EXPECT_FALSE(module_.at_rest());  // the reply is being sent
  module_.on_reply_sent(now_);
  EXPECT_TRUE(module_.at_rest());
  put("~01OPUMP");
  step();
  EXPECT_FALSE(module_.at_rest());                         // the command is being stored
  EXPECT_FALSE(Module(*find_model("EX9043D")).at_rest());  // a module that has not started
}

TEST_F(ModuleTurns, AReadyReplyRequestsAnotherTurnUntilItIsTaken) {
  put("$01M");
  step();
  EXPECT_TRUE(requests_another_turn());
  EXPECT_EQ(take_reply(), "!019043D\r");
  EXPECT_FALSE(requests_another_turn());
}

// wire.md D18.
TEST_F(ModuleTurns, TheGapBeforeTheNextReplyIsKept) {
  put("$01M");
  step();
  put("$01F");
  EXPECT_EQ(take_reply(), "!019043D\r");
  module_.on_reply_sent(now_);
  step();
  EXPECT_EQ(take_reply(), "");
  EXPECT_FALSE(requests_another_turn());
  pass(kCharacter);
  EXPECT_EQ(take_reply(), "");
  pass(Duration(2));
  EXPECT_TRUE(requests_another_turn());
  EXPECT_EQ(take_reply(), "!01D01.00\r");
}

TEST_F(ModuleTurns, TheTurnAfterAStoreAnswersTheCommand) {
  put("~01Opump");
  step();
  while (module_.needs_memory()) {
    EXPECT_FALSE(requests_another_turn());
    do_memory_job();
  }
  step();
  EXPECT_EQ(take_reply(), "!01\r");
}

TEST_F(ModuleTurns, ATimeoutFlashesTheLedInItsTurnAndIsStoredAfterIt) {
  put("~013101");
  step();
  while (module_.needs_memory()) {
    do_memory_job();
  }
  step();
  EXPECT_EQ(take_reply(), "!01\r");
  module_.on_reply_sent(now_);
  step();
  pass(kUnitOfTimeout + milliseconds(1));
  step();
  ASSERT_TRUE(module_.state().settings.timeout_status);
  EXPECT_EQ(module_.led_pattern(), StatusLed::Pattern::HostTimeout);
  EXPECT_FALSE(requests_another_turn());
  ASSERT_TRUE(module_.needs_memory());
  while (module_.needs_memory()) {
    do_memory_job();
  }
  step();
  EXPECT_FALSE(requests_another_turn());
}

// wire.md D15. With more attempts to store the timeout, the reply to the command could begin later than 200
// ms after the command if a record has several pages.
TEST_F(ModuleTurns, AStoreOfATimeoutHasOneAttemptAndAStoreOfACommandHasThree) {
  put("~013101");
  step();
  EXPECT_EQ(module_.memory_job().attempts, 3);
  do_memory_job();
  step();
  ASSERT_EQ(take_reply(), "!01\r");
  module_.on_reply_sent(now_);
  pass(kUnitOfTimeout + milliseconds(1));
  step();
  ASSERT_TRUE(module_.needs_memory());
  EXPECT_EQ(module_.memory_job().attempts, 1);
  put("~013105");
  memory_.answers = false;
  do_memory_job();
  step();
  ASSERT_TRUE(module_.needs_memory()) << "the command waits for only one job";
  EXPECT_EQ(module_.memory_job().attempts, 3);
  do_memory_job();
  step();
  EXPECT_EQ(take_reply(), "?01\r");
}

TEST_F(ModuleTurns, AHostOkWaitsForTheNextTurn) {
  EXPECT_FALSE(module_.frame_waits());
  put("~**");
  EXPECT_TRUE(module_.frame_waits());
  step();
  EXPECT_FALSE(module_.frame_waits());
}

// wire.md section 6: a host OK restarts the host watchdog from the time of its reception, even if the main
// loop processes it later. Here one turn follows three host OKs. The first host OK arrives before the time
// at which the watchdog would expire without a host OK. The second and the third arrive after this time.
TEST_F(ModuleTurns, IfSeveralHostOksArriveBetweenTwoTurnsTheFirstAndTheLastTakeEffect) {
  put("~013101");
  step();
  while (module_.needs_memory()) {
    do_memory_job();
  }
  step();
  ASSERT_TRUE(module_.state().settings.watchdog_enabled);
  pass(kUnitOfTimeout - milliseconds(10));
  put("~**");
  put("~**");
  put("~**");
  ASSERT_TRUE(module_.host_watchdog_expiry().reached(now_));
  step();
  EXPECT_FALSE(module_.state().settings.timeout_status);
  pass(kUnitOfTimeout - kCharacter - kCharacter);  // to 0.1 s after the CR of the last host OK
  step();
  EXPECT_FALSE(module_.state().settings.timeout_status);
  pass(Duration(1));
  step();
  EXPECT_TRUE(module_.state().settings.timeout_status);
}

// The receiver processes `~**` itself and does not queue it, so that a full queue cannot lose it. A direct
// call of `dcon::answer` must have the same effect.
TEST(HostOkCommand, RestartsTheHostWatchdogAndIsNotAnswered) {
  Frame command;
  command.storage = {'~', '*', '*'};
  command.size = 3;
  const State state(*find_model("EX9043D"));
  const LineTallies tallies;
  Exchange exchange(state, tallies);
  exchange.begin(command);
  dcon::answer(exchange);
  EXPECT_TRUE(exchange.outcome.asks_for(Effect::RestartHostWatchdog));
  EXPECT_EQ(exchange.outcome.refusal, Refusal::None);
  EXPECT_TRUE(exchange.reply.empty());
}

}  // namespace
}  // namespace ex9000
