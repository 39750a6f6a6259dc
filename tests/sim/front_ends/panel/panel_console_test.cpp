// Tests the requests that a page of the panel sends on a line.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/notation/fault_notation.hpp"
#include "tests/sim/front_ends/panel/panel_bench.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;

/// Sends a request from the console, and runs the line for a second. Returns the answer; null if there is
/// none.
Message console_answer(PanelBench& bench, const std::string& ask, unsigned address = 1) {
  const Message request{{"id", 9}, {"line", 0}, {"address", address}, {"ask", ask}};
  EXPECT_TRUE(bench.viewer().ask(request.dump())) << ask;
  bench.run(std::chrono::seconds(1));
  const Message message = bench.look();
  return message.contains("answers") ? message["answers"][0] : Message();
}

TEST(PanelConsole, TheAnswerContainsTheReplyItsMeaningAndItsDelay) {
  PanelBench bench("EX9052D-M@01");
  const Message read = console_answer(bench, "02 0000 0008");
  EXPECT_EQ(read["id"], 9);
  EXPECT_EQ(read["ok"], true);
  EXPECT_EQ(read["text"], "01 02 01 00 A1 88");
  EXPECT_EQ(read["meaning"], "from 0000: 0 0 0 0 0 0 0 0");
  EXPECT_GT(read["delay"], 1000);  // in microseconds; at 9600 baud, a character takes 1042 microseconds
  EXPECT_LT(read["delay"], 20'000);
  EXPECT_EQ(console_answer(bench, "03 01E2 0002")["meaning"], "from 01E2: 0090 (144), 5200 (20992)");
  EXPECT_EQ(console_answer(bench, "03 7000 0001")["meaning"], "exception 02: illegal data address");
  EXPECT_EQ(console_answer(bench, "46 00")["meaning"], "01: Module code and address, reply");
}

TEST(PanelConsole, ADconCommandGetsItsReply) {
  PanelBench bench("EX9055D@01");
  const Message name = console_answer(bench, "$01M");
  EXPECT_EQ(name["text"], "!019055\\r");
  EXPECT_EQ(name["meaning"], "reply");
  EXPECT_EQ(console_answer(bench, "$01Z")["meaning"], "rejected");
}

TEST(PanelConsole, ABroadcastHasNoReply) {
  PanelBench bench("EX9055D@01");
  for (const auto& [ask, address] :
       {std::pair("~**", 1U), std::pair("#**", 1U), std::pair("05 0000 FF00", 0U)}) {
    const Message answer = console_answer(bench, ask, address);
    EXPECT_EQ(answer["ok"], true) << ask;
    EXPECT_EQ(answer["meaning"], "sent to all modules, which do not reply") << ask;
  }
}

TEST(PanelConsole, AMissingReplyIsReported) {
  PanelBench bench("EX9052D-M@01");
  const Message answer = console_answer(bench, "02 0000 0008", 2);
  EXPECT_EQ(answer["ok"], false);
  EXPECT_EQ(answer["text"], "no reply within 500 ms");
}

TEST(PanelConsole, ATextThatIsNoRequestIsRefusedWithAReason) {
  PanelBench bench("EX9052D-M@01");
  for (const std::string text : {"", "0", "01 0000 000", "zz", "hello"}) {
    const Message answer = console_answer(bench, text);
    EXPECT_EQ(answer["ok"], false) << text;
    EXPECT_NE(answer["text"].get<std::string>().find("expected a DCON command such as $01M, or a PDU in hex"),
              std::string::npos)
        << text;
  }
  std::string longest;
  for (int i = 0; i < 254; ++i) {
    longest += "00";
  }
  EXPECT_EQ(console_answer(bench, longest)["text"], "254 bytes: expected a PDU of at most 253 bytes");
}

TEST(PanelConsole, AFrameThatIsNotAReplyToTheRequestIsMarked) {
  PanelBench bench("EX9052D-M@01");
  bench.line().faults().add(parse_fault("foreign-traffic 0105000AFF00AC38"));  // takes effect once
  const Message request{{"id", 9}, {"line", 0}, {"address", 2}, {"ask", "02 0000 0008"}};
  ASSERT_TRUE(bench.viewer().ask(request.dump()));
  bench.run(milliseconds(50));
  bench.line().faults().add(parse_fault("foreign-traffic 0105000AFF00AC38"));
  bench.run(std::chrono::seconds(1));
  const Message answer = bench.look()["answers"][0];
  EXPECT_EQ(answer["ok"], false);
  EXPECT_EQ(answer["text"], "01 05 00 0A FF 00 AC 38");
  EXPECT_EQ(answer["meaning"], "not a reply to this request");
}

TEST(PanelConsole, ABroadcastThatWasNotSentIsReported) {
  PanelBench bench("EX9055D@01");
  const std::vector<std::uint8_t> many(1500, '$');  // 1.6 s at 9600 baud
  bench.line().master().send(many.data(), many.size());
  const Message answer = console_answer(bench, "~**");
  EXPECT_EQ(answer["ok"], false);
  EXPECT_EQ(answer["text"], "not sent: other masters did not stop sending within 500 ms");
}

TEST(PanelConsole, TheLongestPduIsAcceptedWithBlanksBut1001CharactersAreRefused) {
  PanelBench bench("EX9052D-M@01");
  std::string longest = "65";
  for (int i = 1; i < 253; ++i) {
    longest += " 00";
  }
  EXPECT_EQ(console_answer(bench, longest)["meaning"], "exception 01: illegal function");
  EXPECT_EQ(console_answer(bench, std::string(1001, ' '))["text"], "1001 characters: expected at most 1000");
}

TEST(PanelConsole, OnePageMayHaveSixteenRequestsInTheQueue) {
  PanelBench bench("EX9052D-M@01");
  const std::string request = R"({"id": 1, "line": 0, "address": 1, "ask": "02 0000 0008"})";
  for (int i = 0; i < 17; ++i) {
    ASSERT_TRUE(bench.viewer().ask(request));
  }
  const Message message = bench.look();
  ASSERT_EQ(message["answers"].size(), 1U);
  EXPECT_EQ(message["answers"][0]["text"], "16 requests of this page have no reply yet; wait for a reply");
  bench.run(std::chrono::seconds(2));
  EXPECT_EQ(bench.look()["answers"].size(), 16U);
}

TEST(PanelConsole, ARequestWithAnInvalidLineOrAddressOrTextOrKeyIsRejected) {
  PanelBench bench("EX9052D-M@01");
  EXPECT_FALSE(bench.viewer().ask(R"({"id": 1, "line": 1, "address": 1, "ask": "07"})"));
  EXPECT_FALSE(bench.viewer().ask(R"({"id": 1, "line": 0, "address": 248, "ask": "07"})"));
  EXPECT_FALSE(bench.viewer().ask(R"({"id": 1, "line": 0, "address": 4294967297, "ask": "07"})"));
  EXPECT_FALSE(bench.viewer().ask(R"({"id": 1, "line": 0, "address": 1, "ask": 7})"));
  EXPECT_FALSE(bench.viewer().ask(R"({"id": 1, "line": 0, "address": 1, "ask": "07", "do": "list"})"));
}

}  // namespace
}  // namespace ex9000::sim
