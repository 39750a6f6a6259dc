// Tests the clients of a TCP port: the limit of their number, and the linger time.
#include "sim/files_and_ports/ports/tcp_port.hpp"
#include "tests/support/stored_arrivals.hpp"

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
  const std::string address = port.summary().address;
  const auto number = static_cast<std::uint16_t>(std::stoul(address.substr(address.rfind(':') + 1)));
  tcp::socket socket(io);
  socket.connect({boost::asio::ip::address_v4::loopback(), number});
  return socket;
}

class TcpPortClients : public testing::Test {
 protected:
  explicit TcpPortClients(TcpPort::Linger linger = std::nullopt) : port_(io_, {"127.0.0.1", 0}, linger) {
    port_.start(arrivals_);
  }

  tcp::socket connect() { return connected(io_, port_); }

  boost::asio::io_context io_;
  TcpPort port_;
  StoredArrivals arrivals_;
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
  while (arrivals_.text.size() < 5) {
    ASSERT_TRUE(run_one(io_)) << "the next client was not accepted";
  }
  EXPECT_EQ(arrivals_.text, "$01M\r");
}

TEST_F(TcpPortClients, AClientThatResetsItsConnectionHasLeft) {
  tcp::socket client = connect();
  boost::asio::write(client, boost::asio::buffer(std::string_view("xxx")));
  while (arrivals_.text.size() < 3) {
    ASSERT_TRUE(run_one(io_));
  }
  EXPECT_EQ(arrivals_.gone, std::vector<Port::Sender>());
  client.set_option(boost::asio::socket_base::linger(true, 0));
  client.close();
  while (arrivals_.gone.empty()) {
    ASSERT_TRUE(run_one(io_)) << "the port has not detected the reset";
  }
  EXPECT_EQ(arrivals_.gone, std::vector<Port::Sender>{arrivals_.sender});
}

/// The unread bytes hide the end of the stream from a port that waits for `resume`.
TEST_F(TcpPortLingering, AClientThatHasClosedWhileThePortReadsNothingHasLeftAfterTheLingerTime) {
  arrivals_.pauses = true;
  tcp::socket client = connect();
  boost::asio::write(client, boost::asio::buffer(std::string(20'000, 'x')));
  client.close();
  while (arrivals_.gone.empty()) {
    ASSERT_TRUE(run_one(io_)) << "the port has kept the client";
  }
  EXPECT_EQ(arrivals_.gone, std::vector<Port::Sender>{arrivals_.sender});
  EXPECT_LT(arrivals_.text.size(), 20'000U);
}

TEST_F(TcpPortClients, TheFirstClientLetsALineGoThatThePortHolds) {
  EXPECT_FALSE(port_.holds_line());
  port_.hold_line();
  EXPECT_TRUE(port_.holds_line());
  const tcp::socket client = connect();
  ASSERT_TRUE(run_one(io_));
  const tcp::socket another = connect();
  ASSERT_TRUE(run_one(io_));
  EXPECT_EQ(arrivals_.connections, 1U);
  EXPECT_FALSE(port_.holds_line());
}

/// The linger time expires before the port is destroyed. The destructor can then no longer cancel the handler
/// of the linger time.
TEST(TcpPort, CanBeDestroyedAfterALingerTimeHasExpired) {
  boost::asio::io_context io;
  auto port = std::make_unique<TcpPort>(io, TcpAddress{"127.0.0.1", 0}, std::chrono::milliseconds(0));
  StoredArrivals arrivals;
  port->start(arrivals);
  tcp::socket client = connected(io, *port);
  ASSERT_TRUE(run_one(io));  // accepts the client
  client.shutdown(tcp::socket::shutdown_send);
  ASSERT_TRUE(run_one(io));  // detects that the client has closed its sending side; starts the linger time
  boost::asio::post(io, [&] { port.reset(); });
  EXPECT_GE(io.poll(), 2U);
}

}  // namespace
}  // namespace ex9000::sim
