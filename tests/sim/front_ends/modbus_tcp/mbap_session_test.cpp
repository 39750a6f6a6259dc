// Tests the sessions of Modbus TCP clients on one line, in virtual time.
#include "sim/front_ends/modbus_tcp/mbap_session.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "sim/notation/module_notation.hpp"
#include "tests/support/environment.hpp"

namespace ex9000::sim {
namespace {

using Buffer = std::vector<std::uint8_t>;
using std::chrono::seconds;

/// A client that sends further requests before it has received all replies, and checks each reply.
class PollingClient {
 public:
  PollingClient(Line& line, unsigned number) : random_(number), session_(line, [this] { take(); }) {}

  void ask() {
    static constexpr std::uint8_t kUnits[] = {1, 2, 9, 250};
    const std::uint8_t unit = kUnits[random_() % 100 < 96 ? random_() % 2 : 2 + random_() % 2];
    const auto transaction = static_cast<std::uint16_t>(random_());
    // With a random quantity, two replies of unit 1 usually differ, because all outputs of unit 1 are on.
    const auto quantity = static_cast<std::uint8_t>(1 + random_() % 8);
    expected_.push_back({transaction, unit, quantity});
    Buffer bytes = mbap_bytes({transaction, unit, {0x01, 0x00, 0x00, 0x00, quantity}});
    pieces_.insert(pieces_.end(), bytes.begin(), bytes.end());
    const std::size_t now = random_() % (pieces_.size() + 1);  // the rest arrives later
    session_.receive({pieces_.data(), now});
    pieces_.erase(pieces_.begin(), pieces_.begin() + static_cast<std::ptrdiff_t>(now));
  }
  void arrive() {
    session_.receive({pieces_.data(), pieces_.size()});
    pieces_.clear();
  }

  [[nodiscard]] std::size_t in_flight() const { return expected_.size(); }
  [[nodiscard]] unsigned answered() const { return answered_; }

 private:
  struct Asked {
    std::uint16_t transaction;
    std::uint8_t unit;
    std::uint8_t quantity;
  };

  void take() {
    MbapReader reader;
    reader.add({session_.replies.data(), session_.replies.size()});
    session_.replies.clear();
    while (const auto reply = reader.next()) {
      check(*reply);
    }
    EXPECT_EQ(reader.size(), 0U);
  }

  void check(const MbapFrame& reply) {
    ASSERT_FALSE(expected_.empty()) << "a reply without a request";
    const Asked asked = expected_.front();
    expected_.pop_front();
    EXPECT_EQ(reply.transaction, asked.transaction);
    EXPECT_EQ(reply.unit, asked.unit);
    const auto all = static_cast<std::uint8_t>((1U << asked.quantity) - 1U);
    switch (asked.unit) {
      case 1:  // all outputs on
        EXPECT_EQ(reply.pdu, (Buffer{0x01, 0x01, all}));
        break;
      case 2:  // all outputs off
        EXPECT_EQ(reply.pdu, (Buffer{0x01, 0x01, 0x00}));
        break;
      case 9:
        EXPECT_EQ(reply.pdu, (Buffer{0x81, 0x0B}));
        break;
      default:
        EXPECT_EQ(reply.pdu, (Buffer{0x81, 0x0A}));
    }
    ++answered_;
  }

  std::mt19937 random_;
  std::deque<Asked> expected_;
  Buffer pieces_;
  unsigned answered_ = 0;
  MbapSession session_;
};

TEST(MbapSession, FiveClientsOnOneLineGetTheirOwnReplies) {
  const seconds duration(number_in_environment("EX9000_VIRTUAL_SECONDS", 60));
  Line line({parse_module_spec("EX9043D-M@01,baud=115200"), parse_module_spec("EX9043D-M@02,baud=115200")},
            kPaced, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
  line.come_up();
  line.master().set_baud(115200);
  const auto owner = std::make_shared<int>();
  ask_on_line(line, {1, 1, {0x0F, 0x00, 0x00, 0x00, 0x10, 0x02, 0xFF, 0xFF}}, owner,
              [](const std::optional<Buffer>& reply) {
                EXPECT_EQ(reply, (Buffer{0x0F, 0x00, 0x00, 0x00, 0x10}));
              });
  line.wires().run_for(seconds(1));
  std::vector<std::unique_ptr<PollingClient>> clients;
  for (unsigned i = 0; i < 5; ++i) {
    clients.push_back(std::make_unique<PollingClient>(line, i));
  }
  const VirtualTime end = line.clock().virtual_now() + duration;
  std::mt19937 random(1);
  while (line.clock().virtual_now() < end) {
    PollingClient& client = *clients[random() % clients.size()];
    if (client.in_flight() < 20) {
      client.ask();
    } else {
      client.arrive();
    }
    line.wires().run_for(std::chrono::milliseconds(random() % 100));
  }
  for (const auto& client : clients) {
    client->arrive();
  }
  line.wires().run_for(seconds(60));
  for (const auto& client : clients) {
    EXPECT_EQ(client->in_flight(), 0U);
    EXPECT_GT(client->answered(), 2 * duration.count());
  }
}

TEST(MbapSession, ClientsTakeTurnsEvenIfOneClientSendsManyRequests) {
  Line line({parse_module_spec("EX9042D-M@01")}, kPaced, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
  line.come_up();
  std::vector<std::string> order;
  const auto client = [&](const std::string& name) {
    return std::make_unique<MbapSession>(line, [&order, name] { order.push_back(name); });
  };
  const auto many = client("many");
  const auto one = client("one");
  const Buffer to_nobody = mbap_bytes({1, 9, {0x01, 0x00, 0x00, 0x00, 0x0D}});
  for (int i = 0; i < 20; ++i) {
    many->receive({to_nobody.data(), to_nobody.size()});
  }
  one->receive({to_nobody.data(), to_nobody.size()});
  line.wires().run_for(std::chrono::milliseconds(500));  // two timeouts of 220 ms
  EXPECT_EQ(order, (std::vector<std::string>{"many", "one"}));
}

TEST(MbapSession, WaitingRequestsOfADisconnectedClientAreNotSent) {
  Line line({parse_module_spec("EX9042D-M@01")}, kPaced, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
  line.come_up();
  auto session = std::make_unique<MbapSession>(
      line, [] { ADD_FAILURE() << "a reply after the client has disconnected"; });
  for (std::uint8_t output = 0; output < 2; ++output) {
    const Buffer bytes = mbap_bytes({1, 1, {0x05, 0x00, output, 0xFF, 0x00}});
    session->receive({bytes.data(), bytes.size()});
  }
  session.reset();
  line.wires().run_for(seconds(2));
  EXPECT_EQ(line.module(0).outputs(), 0x0001);  // the first request was on the line already
}

}  // namespace
}  // namespace ex9000::sim
