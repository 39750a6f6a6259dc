// Tests a request from its judgement to the end of its reply: wire.md sections 3, 7 and 8, D17 and D18.
#include "firmware/request/request_cycle.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"

namespace ex9000 {
namespace {

using Phase = RequestCycle::Phase;

constexpr Duration kCharacter{1042};  // at 9600 baud

class RequestCycleTest : public testing::Test {
 protected:
  RequestCycleTest() {
    cycle_.keep_apart(kCharacter);
    state_.settings = Settings::factory(*find_model("EX9042D-M"));
    state_.in_force.address = 1;
  }

  const Outcome& judge(const std::string& request) {
    request_.assign(request.begin(), request.end());
    return cycle_.judge({request_.data(), request_.size()}, now_);
  }
  /// Switches to Modbus RTU and judges `request`, which must be without its CRC.
  const Outcome& judge_modbus(std::vector<std::uint8_t> request) {
    state_.in_force.protocol = Protocol::ModbusRtu;
    request_ = std::move(request);
    return cycle_.judge({request_.data(), request_.size()}, now_);
  }
  void end_reply() {
    cycle_.on_reply_sent(now_);
    cycle_.poll(now_);
  }
  std::string take_reply() {
    const Bytes reply = cycle_.take_reply(now_);
    return {reply.begin(), reply.end()};
  }

  State state_{*find_model("EX9042D-M")};
  LineTallies tallies_;
  RequestCycle cycle_{state_, tallies_};
  Time now_{1000};

 private:
  std::vector<std::uint8_t> request_;
};

TEST_F(RequestCycleTest, IsIdleAtFirstAndHasNoReply) {
  EXPECT_EQ(cycle_.phase(), Phase::Idle);
  EXPECT_EQ(take_reply(), "");
}

TEST_F(RequestCycleTest, ARequestThatChangesNoSettingsIsAnsweredAfterItIsFinished) {
  EXPECT_FALSE(judge("$01M").changes_settings());
  EXPECT_EQ(cycle_.phase(), Phase::Idle);
  EXPECT_EQ(take_reply(), "");
  EXPECT_TRUE(cycle_.finish());
  EXPECT_EQ(cycle_.phase(), Phase::ReplyReady);
  EXPECT_EQ(take_reply(), "!019042M\r");
  EXPECT_EQ(cycle_.phase(), Phase::Idle);
  EXPECT_TRUE(cycle_.replying());
  EXPECT_FALSE(cycle_.free());
  cycle_.on_reply_sent(now_);
  EXPECT_FALSE(cycle_.replying());
  cycle_.poll(now_);
  EXPECT_TRUE(cycle_.free());
}

TEST_F(RequestCycleTest, ARequestWithoutAReplyIsOverWhenItIsFinished) {
  EXPECT_TRUE(judge("#**").asks_for(Effect::TakeSample));
  EXPECT_FALSE(cycle_.finish());
  EXPECT_EQ(cycle_.phase(), Phase::Idle);
  EXPECT_FALSE(cycle_.outcome().has_effects());
}

TEST_F(RequestCycleTest, ARequestThatChangesSettingsIsStoredBeforeItIsAnswered) {
  EXPECT_TRUE(judge("~01OPUMP").changes_settings());
  EXPECT_EQ(cycle_.phase(), Phase::AwaitingStore);
  EXPECT_EQ(take_reply(), "");
  cycle_.store_begun();
  EXPECT_EQ(cycle_.phase(), Phase::Storing);
  EXPECT_EQ(take_reply(), "");
  EXPECT_TRUE(cycle_.finish());
  EXPECT_EQ(take_reply(), "!01\r");
}

TEST_F(RequestCycleTest, ARefusedRequestHasARefusalAndNoEffects) {
  const Outcome& outcome = judge("~0130FF?");
  EXPECT_EQ(outcome.refusal, Refusal::UnknownCommand);
  EXPECT_FALSE(outcome.changes_settings());
  EXPECT_FALSE(outcome.has_effects());
  EXPECT_TRUE(cycle_.finish());
  EXPECT_EQ(take_reply(), "?01\r");
}

TEST_F(RequestCycleTest, ARequestWhoseStoreFailsIsRefusedInBothProtocols) {
  judge("~01OPUMP");
  cycle_.store_begun();
  cycle_.refuse_store();
  EXPECT_FALSE(cycle_.outcome().changes_settings());
  EXPECT_EQ(cycle_.outcome().refusal, Refusal::StoreFailed);
  EXPECT_TRUE(cycle_.finish());
  EXPECT_EQ(take_reply(), "?01\r");
  end_reply();
  now_ = now_ + kCharacter;

  judge_modbus({0x01, 0x06, 0x01, 0xE8, 0x00, 0x05});
  cycle_.store_begun();
  cycle_.refuse_store();
  EXPECT_TRUE(cycle_.finish());
  const std::vector<std::uint8_t> exception = with_crc({0x01, 0x86, 0x04});
  EXPECT_EQ(take_reply(), std::string(exception.begin(), exception.end()));
}

TEST_F(RequestCycleTest, ABroadcastThatCannotBeStoredGetsNoReply) {
  judge_modbus({0x00, 0x06, 0x01, 0xE8, 0x00, 0x05});
  cycle_.store_begun();
  cycle_.refuse_store();
  EXPECT_FALSE(cycle_.finish());
}

TEST_F(RequestCycleTest, ABroadcastDoesNotAffectTheNextRequest) {
  judge_modbus({0x00, 0x06, 0x01, 0xE8, 0x00, 0x05});
  cycle_.finish();
  EXPECT_FALSE(judge_modbus({0x01, 0x01, 0x00, 0x00, 0x00, 0x01}).changes_settings());
  EXPECT_TRUE(cycle_.finish());  // this request gets a reply
}

// wire.md D17.
TEST_F(RequestCycleTest, ACommandDoesNotClearTheStatusOfATimeoutThatOccursDuringTheCommand) {
  state_.settings.timeout_status = true;
  judge("~011");
  EXPECT_FALSE(cycle_.outcome().change().applied_to(state_.settings).timeout_status);
  cycle_.keep_timeout_status();
  EXPECT_TRUE(cycle_.outcome().change().applied_to(state_.settings).timeout_status);
  EXPECT_TRUE(cycle_.finish());
}

TEST_F(RequestCycleTest, ACommandClearsTheStatusOfATimeoutThatOccurredBeforeTheCommand) {
  state_.settings.timeout_status = true;
  cycle_.keep_timeout_status();
  judge("~011");
  EXPECT_FALSE(cycle_.outcome().change().applied_to(state_.settings).timeout_status);
}

TEST_F(RequestCycleTest, AnEndWithoutAReplyDoesNotBlockTheNextRequest) {
  end_reply();  // for example, a timer that a reset has not stopped
  EXPECT_FALSE(cycle_.replying());
  EXPECT_TRUE(cycle_.free());
}

// wire.md D18.
TEST_F(RequestCycleTest, TheNextReplyStartsAfterTheGapThatFollowsThePreviousReply) {
  judge("$01M");
  cycle_.finish();
  take_reply();
  end_reply();
  judge("$01F");
  cycle_.finish();
  EXPECT_EQ(cycle_.reply_due().remaining(now_).microseconds(), kCharacter.microseconds());
  now_ = now_ + Duration(kCharacter.microseconds() - 1);
  EXPECT_EQ(take_reply(), "");
  now_ = now_ + Duration(1);
  EXPECT_TRUE(cycle_.reply_due().reached(now_));
  EXPECT_EQ(take_reply(), "!01D01.00\r");
}

TEST_F(RequestCycleTest, AReplyLongAgoDoesNotDelayTheNextReply) {
  judge("$01M");
  cycle_.finish();
  take_reply();
  end_reply();
  for (int minute = 0; minute < 60; ++minute) {
    now_ = now_ + milliseconds(60'000);
    cycle_.poll(now_);
  }
  judge("$01F");
  cycle_.finish();
  EXPECT_EQ(take_reply(), "!01D01.00\r");
}

// firmware/extensions.md: the response delay.
TEST_F(RequestCycleTest, AReplyWaitsForTheLaterOfTheGapAndTheResponseDelay) {
  for (const auto& [gap, delay] : {std::pair{5U, 30U}, {30U, 5U}}) {
    cycle_.keep_apart(milliseconds(gap));
    judge("$01M");
    cycle_.finish();
    take_reply();
    end_reply();
    judge("$01M");
    cycle_.hold_reply_until(now_ + milliseconds(delay));
    cycle_.finish();
    now_ = now_ + milliseconds(29);
    EXPECT_EQ(take_reply(), "");
    EXPECT_EQ(cycle_.reply_due().remaining(now_).microseconds(), 1000U);
    now_ = now_ + milliseconds(1);
    EXPECT_NE(take_reply(), "");
    end_reply();
    now_ = now_ + milliseconds(30);
    cycle_.poll(now_);
  }
}

TEST_F(RequestCycleTest, HoldReplyUntilDoesNotDelayTheReplyToTheNextRequest) {
  judge("$01M");
  cycle_.hold_reply_until(now_ + milliseconds(30));
  judge("$01M");
  cycle_.finish();
  EXPECT_NE(take_reply(), "");
}

}  // namespace
}  // namespace ex9000
