// The master for Modbus TCP, with what a gateway may send.
#include <gtest/gtest.h>

#include <deque>

#include "sim/utility/modbus/master.hpp"

namespace ex9000::utility {
namespace {

/// Gives prepared bytes, one piece for each `receive`. Its time passes only while it has none.
class Gateway final : public Connection {
 public:
  void set_mode(hal::SerialMode /*mode*/) override {}
  void send(const Data& bytes) override { sent = bytes; }
  Data receive(Time patience) override {
    if (pieces.empty()) {
      now_ += patience;
      return {};
    }
    const Data piece = pieces.front();
    pieces.pop_front();
    return piece;
  }
  Time now() override { return now_; }

  Data sent;
  std::deque<Data> pieces;

 private:
  Time now_{0};
};

class TcpMasters : public testing::Test {
 protected:
  Data read_coils(const std::deque<Data>& pieces) {
    gateway_.pieces = pieces;
    return master_->exchange(at_address(5), read_bits(0, 13), std::chrono::milliseconds(100));
  }

  Gateway gateway_;
  std::unique_ptr<Master> master_ = tcp_master(gateway_);
};

TEST_F(TcpMasters, TakeTheReplyToTheRequest) {
  const Data reply{0x01, 0x02, 0x05, 0x10};
  EXPECT_EQ(read_coils({{0, 1, 0, 0, 0, 5, 5, 0x01, 0x02, 0x05, 0x10}}), reply);
  EXPECT_EQ(gateway_.sent, (Data{0, 1, 0, 0, 0, 6, 5, 0x01, 0x00, 0x00, 0x00, 0x0D}));
  // In pieces, after that to an earlier request and one of another function.
  EXPECT_EQ(read_coils({{0, 1, 0, 0, 0, 5, 5, 0x01, 0x02, 0xFF, 0xFF, 0, 2, 0, 0, 0, 4, 5, 0x03, 0x01},
                        {0x00, 0, 2, 0},
                        {0, 0, 5, 5, 0x01, 0x02, 0x05, 0x10}}),
            reply);
}

TEST_F(TcpMasters, TakeAnException) {
  EXPECT_EQ(read_coils({{0, 1, 0, 0, 0, 3, 5, 0x81, 0x02}}), (Data{0x81, 0x02}));
}

/// Exception 0B: the gateway says that the module gives none.
TEST_F(TcpMasters, KnowThatThereIsNoReply) {
  EXPECT_EQ(read_coils({{0, 1, 0, 0, 0, 3, 5, 0x81, 0x0B}}), Data());
  EXPECT_EQ(read_coils({}), Data());
}

TEST_F(TcpMasters, RefuseWhatIsNoModbusTcp) {
  EXPECT_THROW(read_coils({{'H', 'T', 'T', 'P', '/', '1', '.', '1', ' ', '4'}}), std::runtime_error);
  EXPECT_THROW(master_->exchange(with_serial_number(0x0D000001), read_bits(0, 1), Time(0)),
               std::invalid_argument);
}

}  // namespace
}  // namespace ex9000::utility
