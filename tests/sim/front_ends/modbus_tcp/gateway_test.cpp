// Tests the gateway from Modbus TCP to a line, in virtual time.
#include "sim/front_ends/modbus_tcp/gateway.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/notation/fault_notation.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/virtual_line/line/rtu_frame.hpp"

namespace ex9000::sim {
namespace {

using Pdu = std::vector<std::uint8_t>;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint8_t kPathUnavailable = 0x0A;
constexpr std::uint8_t kNoReply = 0x0B;
const Pdu kReadOutputs{0x01, 0x00, 0x00, 0x00, 0x0D};
const Pdu kOutputsOff{0x01, 0x02, 0x00, 0x00};
const Pdu kOutput0On{0x05, 0x00, 0x00, 0xFF, 0x00};

class GatewayLine {
 public:
  explicit GatewayLine(const std::vector<std::string>& modules)
      : line(specs(modules), kPaced, [](auto...) {}) {
    line.come_up();
  }

  struct Result {
    bool answered = false;
    std::optional<Pdu> pdu;
    VirtualTime at{0};
  };

  /// Sends a request to the gateway, runs the line for `time`, and returns the answer and its time.
  Result ask(std::uint8_t unit, const Pdu& pdu, VirtualTime time = seconds(2)) {
    Result result;
    ask_on_line(line, {1, unit, pdu}, owner, [&](const std::optional<Pdu>& answer) {
      EXPECT_FALSE(result.answered) << "answered twice";
      result = {true, answer, line.clock().virtual_now()};
    });
    line.wires().run_for(time);
    return result;
  }
  Pdu reply(std::uint8_t unit, const Pdu& pdu) { return ask(unit, pdu).pdu.value_or(Pdu()); }

  Line line;
  std::shared_ptr<int> owner = std::make_shared<int>();

 private:
  static std::vector<ModuleSpec> specs(const std::vector<std::string>& modules) {
    std::vector<ModuleSpec> all;
    for (const std::string& module : modules) {
      all.push_back(parse_module_spec(module));
    }
    return all;
  }
};

TEST(Gateway, AnExceptionReplyOfTheModuleReachesTheClient) {
  GatewayLine bench({"EX9042D-M@01"});
  EXPECT_EQ(bench.reply(0x01, {0x03, 0x00, 0x00, 0x00, 0x01}), (Pdu{0x83, 0x02}));
  EXPECT_EQ(bench.reply(0x01, {0x07}), (Pdu{0x87, 0x01}));
}

TEST(Gateway, Unit0IsABroadcastWithoutReply) {
  GatewayLine bench({"EX9042D-M@01", "EX9042D-M@02"});
  const GatewayLine::Result result = bench.ask(0x00, kOutput0On);
  EXPECT_TRUE(result.answered);
  EXPECT_FALSE(result.pdu);
  EXPECT_EQ(bench.line.module(0).outputs(), 0x0001);
  EXPECT_EQ(bench.line.module(1).outputs(), 0x0001);
}

TEST(Gateway, UnitsAbove247GetException0A) {
  GatewayLine bench({"EX9042D-M@01"});
  for (unsigned unit = 248; unit <= 255; ++unit) {
    EXPECT_EQ(bench.reply(static_cast<std::uint8_t>(unit), kReadOutputs), (Pdu{0x81, kPathUnavailable}))
        << unit;
  }
}

TEST(Gateway, AUnitWithoutModuleGetsException0BAfterTheTimeout) {
  GatewayLine bench({"EX9042D-M@01"});
  const VirtualTime asked = bench.line.clock().virtual_now();
  const GatewayLine::Result result = bench.ask(0x02, kReadOutputs);
  EXPECT_EQ(result.pdu, (Pdu{0x81, kNoReply}));
  // 9600 baud 8N1, 10 bits a byte: the request of 8 bytes, a silence of 3.5 characters of 11 bits, and the
  // reply of 7 bytes take 8.3 ms, 4.0 ms and 7.3 ms.
  EXPECT_GE(result.at - asked, milliseconds(200 + 19));
  EXPECT_LE(result.at - asked, milliseconds(200 + 22));
}

TEST(Gateway, TheTimeoutGrowsWithTheLongestResponseDelay) {
  GatewayLine bench({"EX9042D-M@01", "EX9042D-M@02"});
  const auto time_until_exception = [&bench] {
    const VirtualTime asked = bench.line.clock().virtual_now();
    return bench.ask(0x03, kReadOutputs).at - asked;
  };
  const VirtualTime without = time_until_exception();
  EXPECT_EQ(bench.reply(0x02, {0x06, 0x02, 0x52, 0x00, 0x1E}), (Pdu{0x06, 0x02, 0x52, 0x00, 0x1E}));
  EXPECT_EQ(time_until_exception() - without, milliseconds(30));
}

TEST(Gateway, HostOkGetsException0BBecauseAModuleNeverRepliesToIt) {
  GatewayLine bench({"EX9042D-M@01"});
  EXPECT_EQ(bench.reply(0x01, {0x03, 0x30, 0x38, 0x00, 0x01}), (Pdu{0x83, kNoReply}));
  EXPECT_EQ(bench.reply(0x01, {0x04, 0x30, 0x38, 0x00, 0x00}), (Pdu{0x84, kNoReply}));
}

TEST(Gateway, AUnitOnALineOfAsciiModulesGetsException0A) {
  GatewayLine bench({"EX9042D@01", "EX9042D-M@02,protocol=ascii"});
  EXPECT_EQ(bench.reply(0x01, kReadOutputs), (Pdu{0x81, kPathUnavailable}));
  EXPECT_EQ(bench.reply(0x05, {0x46, 0x00}), (Pdu{0xC6, kPathUnavailable}));
  const GatewayLine::Result broadcast = bench.ask(0x00, kOutput0On);
  EXPECT_TRUE(broadcast.answered);
  EXPECT_FALSE(broadcast.pdu);
  EXPECT_EQ(bench.line.module(0).outputs(), 0);
}

TEST(Gateway, AModuleWithInitSpeaksAsciiUntilAStartWithoutInit) {
  GatewayLine bench({"EX9042D-M@01,init=on"});
  EXPECT_EQ(bench.reply(0x01, kReadOutputs), (Pdu{0x81, kPathUnavailable}));
  bench.line.module(0).set_init(false);
  bench.line.module(0).power(false);
  bench.line.module(0).power(true);
  bench.line.wires().run_for(seconds(1));
  EXPECT_EQ(bench.reply(0x01, kReadOutputs), kOutputsOff);
}

TEST(Gateway, AModbusModuleRepliesOnALineThatAlsoHasAnAsciiModule) {
  GatewayLine bench({"EX9042D@01", "EX9042D-M@02"});
  EXPECT_EQ(bench.reply(0x02, kReadOutputs), kOutputsOff);
  EXPECT_EQ(bench.reply(0x01, kReadOutputs), (Pdu{0x81, kNoReply}));
}

TEST(Gateway, ALostReplyCausesException0BAndTheNextRequestGetsItsReply) {
  GatewayLine bench({"EX9042D-M@01"});
  bench.line.faults().add(parse_fault("lost-reply every 2nd reply"));
  EXPECT_EQ(bench.reply(0x01, kReadOutputs), kOutputsOff);
  EXPECT_EQ(bench.reply(0x01, kOutput0On), (Pdu{0x85, kNoReply}));
  EXPECT_EQ(bench.reply(0x01, kReadOutputs), (Pdu{0x01, 0x02, 0x01, 0x00}));
}

TEST(Gateway, TheEchoOfARequestThatReadsIsNotItsReply) {
  GatewayLine bench({"EX9042D-M@01"});
  bench.line.faults().add(parse_fault("echo 1ms"));
  EXPECT_EQ(bench.reply(0x09, kReadOutputs), (Pdu{0x81, kNoReply}));
}

TEST(RtuReply, FitsTheAddressTheFunctionAndTheQuantityOrValuesOfItsRequest) {
  const auto is_reply = [](const Pdu& reply, const Pdu& request, std::uint8_t address = 0x01) {
    const std::vector<std::uint8_t> frame = rtu_frame(0x01, reply);
    const std::vector<std::uint8_t> sent = rtu_frame(address, request);
    return is_rtu_reply({sent.data(), sent.size()}, {frame.data(), frame.size()});
  };
  const Pdu read_coils{0x01, 0x00, 0x00, 0x00, 0x0D};
  EXPECT_TRUE(is_reply({0x01, 0x02, 0x00, 0x00}, read_coils));
  EXPECT_FALSE(is_reply({0x01, 0x02, 0x00, 0x00}, read_coils, 0x02));
  EXPECT_FALSE(is_reply({0x01, 0x01, 0x00}, read_coils));
  EXPECT_FALSE(is_reply({0x01, 0x02, 0x00}, read_coils));
  EXPECT_FALSE(is_reply(read_coils, read_coils));
  EXPECT_FALSE(is_reply({0x02, 0x02, 0x00, 0x00}, read_coils));
  EXPECT_TRUE(is_reply({0x02, 0x02, 0x00, 0x00}, {0x02, 0x00, 0x00, 0x00, 0x0D}));
  EXPECT_FALSE(is_reply({0x02, 0x01, 0x00}, {0x02, 0x00, 0x00, 0x00, 0x0D}));
  EXPECT_FALSE(is_reply({0x03, 0x02, 0x00, 0x00}, {0x03, 0x00, 0x00, 0x00, 0x02}));
  const Pdu read_words{0x04, 0x00, 0x00, 0x00, 0x02};
  EXPECT_TRUE(is_reply({0x04, 0x04, 0x00, 0x00, 0x00, 0x00}, read_words));
  EXPECT_FALSE(is_reply({0x04, 0x02, 0x00, 0x00}, read_words));
  const Pdu write_coil{0x05, 0x00, 0x01, 0xFF, 0x00};
  EXPECT_TRUE(is_reply(write_coil, write_coil));
  EXPECT_FALSE(is_reply({0x05, 0x00, 0x02, 0xFF, 0x00}, write_coil));
  EXPECT_FALSE(is_reply({0x05, 0x00, 0x01, 0x00, 0x00}, write_coil));
  EXPECT_FALSE(is_reply({0x06, 0x01, 0xE8, 0x00, 0x65}, {0x06, 0x01, 0xE8, 0x00, 0x64}));
  EXPECT_FALSE(is_reply({0x0F, 0x00, 0x00, 0x00, 0x03}, {0x0F, 0x00, 0x00, 0x00, 0x02, 0x01, 0x03}));
  const Pdu write_words{0x10, 0x01, 0xE8, 0x00, 0x01, 0x02, 0x00, 0x64};
  EXPECT_TRUE(is_reply({0x10, 0x01, 0xE8, 0x00, 0x01}, write_words));
  EXPECT_FALSE(is_reply({0x10, 0x01, 0xE8, 0x00, 0x02}, write_words));
  EXPECT_FALSE(is_reply({0x10, 0x01, 0xE8}, write_words));
  EXPECT_TRUE(is_reply({0x81, 0x02}, read_coils));
  EXPECT_FALSE(is_reply({0x81, 0x02, 0x00}, read_coils));
  EXPECT_TRUE(is_reply({0x81, 0x03}, {0x01}));
  EXPECT_FALSE(is_reply({0x01, 0x02, 0x00, 0x00}, {0x01}));
  EXPECT_TRUE(is_reply({0x46, 0x00, 0x00, 0x90, 0x42, 0x00}, {0x46, 0x00}));
}

/// Returns the answers to six requests, one for each of the coils 0 to 5. The gateway gets all requests at
/// the same time, and each reply of the module is 600 ms late.
template <class RequestFor>
std::vector<Pdu> answers_if_replies_are_late(GatewayLine& bench, RequestFor request_for) {
  bench.line.faults().add(parse_fault("late-reply 600ms"));
  std::vector<Pdu> answers;
  for (std::uint8_t coil = 0; coil < 6; ++coil) {
    ask_on_line(bench.line, {1, 0x01, request_for(coil)}, bench.owner,
                [&](const std::optional<Pdu>& answer) { answers.push_back(answer.value_or(Pdu())); });
  }
  bench.line.wires().run_for(seconds(10));
  return answers;
}

TEST(Gateway, ALateReplyToAWriteIsNotTheReplyToTheNextWrite) {
  GatewayLine bench({"EX9042D-M@01"});
  const auto write = [](std::uint8_t coil) { return Pdu{0x05, 0x00, coil, 0xFF, 0x00}; };
  EXPECT_EQ(answers_if_replies_are_late(bench, write), std::vector<Pdu>(6, Pdu{0x85, kNoReply}));
}

TEST(Gateway, ALateReplyToAReadIsNotTheReplyToTheNextRead) {
  GatewayLine bench({"EX9042D-M@01"});
  bench.reply(0x01, kOutput0On);
  // All replies have the same form, but only the first one has the value 1.
  const auto read = [](std::uint8_t coil) { return Pdu{0x01, 0x00, coil, 0x00, 0x01}; };
  EXPECT_EQ(answers_if_replies_are_late(bench, read), std::vector<Pdu>(6, Pdu{0x81, kNoReply}));
}

TEST(Gateway, TheReplyToAnotherMasterIsNotTheReplyToTheClient) {
  GatewayLine bench({"EX9042D-M@01"});
  bench.reply(0x01, kOutput0On);
  bench.line.faults().add(parse_fault("lost-reply every 2nd reply"));
  const Pdu read_coil_0{0x01, 0x00, 0x00, 0x00, 0x01};
  EXPECT_EQ(bench.reply(0x01, read_coil_0), (Pdu{0x01, 0x01, 0x01}));
  std::optional<Pdu> reply;
  ask_on_line(bench.line, {1, 0x01, read_coil_0}, bench.owner,
              [&](const std::optional<Pdu>& answer) { reply = answer; });
  bench.line.wires().run_for(milliseconds(100));  // the reply of the module is lost
  const std::vector<std::uint8_t> other = rtu_frame(0x01, {0x01, 0x00, 0x05, 0x00, 0x01});
  bench.line.master().send(other.data(), other.size());
  bench.line.wires().run_for(seconds(2));
  EXPECT_EQ(reply, (Pdu{0x81, kNoReply}));
}

TEST(Gateway, AModuleThatStartsUpIsNotTreatedAsAnAsciiModule) {
  GatewayLine bench({"EX9042D-M@01"});
  bench.line.module(0).power(false);
  bench.line.module(0).power(true);
  EXPECT_EQ(bench.reply(0x01, kReadOutputs), (Pdu{0x81, kNoReply}));
}

TEST(Gateway, PdusOf1To253BytesReachTheLine) {
  GatewayLine bench({"EX9042D-M@01"});
  for (const std::size_t size : {1U, 2U, 100U, 252U, 253U}) {
    Pdu pdu(size, 0x00);
    pdu[0] = 0x65;
    EXPECT_EQ(bench.reply(0x01, pdu), (Pdu{0xE5, 0x01})) << size;
  }
}

}  // namespace
}  // namespace ex9000::sim
