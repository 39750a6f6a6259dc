// Tests the clients of a TCP port: the limit of their number, and the linger time.
#include "sim/files_and_ports/ports/tcp_port.hpp"

#include <gtest/gtest.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ex9000::sim {
namespace {

using boost::asio::ip::tcp;

constexpr std::size_t kMostMasters = 64;

/// Waits for a handler and runs it. Returns false if no handler is ready within 60 s. Only a port that
/// hangs reaches this limit.
bool run_one(boost::asio::io_context& io) { return io.run_one_for(std::chrono::seconds(60)) == 1; }

tcp::socket connected(boost::asio::io_context& io, const TcpPort& port) {
  const std::string address = port.address();
  const auto number = static_cast<std::uint16_t>(std::stoul(address.substr(address.rfind(':') + 1)));
  tcp::socket socket(io);
  socket.connect({boost::asio::ip::address_v4::loopback(), number});
  return socket;
}

class TcpPortClients : public testing::Test {
 protected:
  explicit TcpPortClients(TcpPort::Linger linger = std::nullopt) : port_(io_, {"127.0.0.1", 0}, linger) {
    port_.start([this](const std::uint8_t* bytes, std::size_t size, const Port::Positions& /*damaged*/,
                       Port::Sender sender) {
      sender_ = sender;
      received_.insert(received_.end(), bytes, bytes + size);
      return !pauses_;
    });
    port_.on_left([this](Port::Sender sender) { left_.push_back(sender); });
  }

  tcp::socket connect() { return connected(io_, port_); }

  boost::asio::io_context io_;
  TcpPort port_;
  std::string received_;
  bool pauses_ = false;
  Port::Sender sender_ = nullptr;
  std::vector<Port::Sender> left_;
};

class TcpPortLingering : public TcpPortClients {
 protected:
  TcpPortLingering() : TcpPortClients(std::chrono::milliseconds(1)) {}
};

TEST_F(TcpPortClients, AtTheMaximumNumberOfClientsANewClientReplacesAHalfClosedClient) {
  std::vector<tcp::socket> clients;
  for (std::size_t i = 0; i < kMostMasters; ++i) {
    clients.push_back(connect());
    ASSERT_TRUE(run_one(io_));  // accepts the client
    clients.back().shutdown(tcp::socket::shutdown_send);
    ASSERT_TRUE(run_one(io_));  // detects that the client has closed its sending side
  }
  tcp::socket next = connect();
  boost::asio::write(next, boost::asio::buffer(std::string_view("$01M\r")));
  while (received_.size() < 5) {
    ASSERT_TRUE(run_one(io_)) << "the next client was not accepted";
  }
  EXPECT_EQ(received_, "$01M\r");
}

TEST_F(TcpPortClients, AClientThatResetsItsConnectionHasLeft) {
  tcp::socket client = connect();
  boost::asio::write(client, boost::asio::buffer(std::string_view("xxx")));
  while (received_.size() < 3) {
    ASSERT_TRUE(run_one(io_));
  }
  EXPECT_EQ(left_, std::vector<Port::Sender>());
  client.set_option(boost::asio::socket_base::linger(true, 0));
  client.close();
  while (left_.empty()) {
    ASSERT_TRUE(run_one(io_)) << "the port has not detected the reset";
  }
  EXPECT_EQ(left_, std::vector<Port::Sender>{sender_});
}

/// The unread bytes hide the end of the stream from a port that waits for `resume`.
TEST_F(TcpPortLingering, AClientThatHasClosedWhileThePortReadsNothingHasLeftAfterTheLingerTime) {
  pauses_ = true;
  tcp::socket client = connect();
  boost::asio::write(client, boost::asio::buffer(std::string(20'000, 'x')));
  client.close();
  while (left_.empty()) {
    ASSERT_TRUE(run_one(io_)) << "the port has kept the client";
  }
  EXPECT_EQ(left_, std::vector<Port::Sender>{sender_});
  EXPECT_LT(received_.size(), 20'000U);
}

/// The linger time expires before the port is destroyed. The destructor can then no longer cancel the handler
/// of the linger time.
TEST(TcpPort, CanBeDestroyedAfterALingerTimeHasExpired) {
  boost::asio::io_context io;
  auto port = std::make_unique<TcpPort>(io, TcpAddress{"127.0.0.1", 0}, std::chrono::milliseconds(0));
  port->start([](const std::uint8_t*, std::size_t, const Port::Positions&, Port::Sender) { return true; });
  tcp::socket client = connected(io, *port);
  ASSERT_TRUE(run_one(io));  // accepts the client
  client.shutdown(tcp::socket::shutdown_send);
  ASSERT_TRUE(run_one(io));  // detects that the client has closed its sending side; starts the linger time
  boost::asio::post(io, [&] { port.reset(); });
  EXPECT_GE(io.poll(), 2U);
}

}  // namespace
}  // namespace ex9000::sim
