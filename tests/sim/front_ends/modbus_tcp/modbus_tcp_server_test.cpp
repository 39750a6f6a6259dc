// Tests the connections of a Modbus TCP server.
#include "sim/front_ends/modbus_tcp/modbus_tcp_server.hpp"

#include <gtest/gtest.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sim/front_ends/modbus_tcp/mbap.hpp"
#include "sim/notation/module_notation.hpp"
#include "tests/support/stored_arrivals.hpp"

namespace ex9000::sim {
namespace {

using boost::asio::ip::tcp;
using Buffer = std::vector<std::uint8_t>;

constexpr std::size_t kMostClients = 64;
const Buffer kReadOutputs{0x01, 0x00, 0x00, 0x00, 0x0D};
const Buffer kOutputsOff{0x01, 0x02, 0x00, 0x00};

Buffer request(std::uint16_t transaction) { return mbap_bytes({transaction, 1, kReadOutputs}); }
Buffer reply(std::uint16_t transaction) { return mbap_bytes({transaction, 1, kOutputsOff}); }

/// A server on an instant line. After the constructor, the time of the line passes only in `pass`.
class ModbusTcpServerTest : public testing::Test {
 protected:
  ModbusTcpServerTest() {
    line_.come_up();
    server_.start(arrivals_);
  }

  /// Connects a client. `buffer` limits the bytes that the system stores for the client in each direction; 0:
  /// the usual limit.
  tcp::socket connect(int buffer = 0) {
    const std::string address = server_.summary().address;
    const auto number = static_cast<std::uint16_t>(std::stoul(address.substr(address.rfind(':') + 1)));
    tcp::socket socket(io_, tcp::v4());
    if (buffer != 0) {
      socket.set_option(boost::asio::socket_base::receive_buffer_size(buffer));
      socket.set_option(boost::asio::socket_base::send_buffer_size(buffer));
    }
    socket.connect({boost::asio::ip::address_v4::loopback(), number});
    return socket;
  }
  static void send(tcp::socket& client, const Buffer& bytes) {
    boost::asio::write(client, boost::asio::buffer(bytes));
  }

  /// Lets the server read until `bytes` bytes have arrived in total. Throws std::runtime_error if the server
  /// does nothing for 60 s, because only a server that hangs takes so long.
  void wait_for_arrival(std::size_t bytes) {
    while (arrivals_.requested < bytes) {
      if (io_.run_one_for(std::chrono::seconds(60)) == 0) {
        throw std::runtime_error("the server has read only " + std::to_string(arrivals_.requested) +
                                 " bytes");
      }
    }
  }
  /// Calls every `process` function that has arrived, and then runs the line for `time`.
  void pass(VirtualTime time = std::chrono::seconds(1)) {
    for (const auto& process : std::exchange(arrivals_.processes, {})) {
      process();
    }
    line_.wires().run_for(time);
  }
  static Buffer receive(tcp::socket& client, std::size_t size) {
    Buffer bytes(size);
    boost::system::error_code error;
    bytes.resize(boost::asio::read(client, boost::asio::buffer(bytes), error));
    return bytes;
  }
  /// Returns whether the server has closed the connection and no byte is left to read. Blocks while the
  /// connection is open and no byte arrives.
  bool closed(tcp::socket& client) {
    io_.poll();
    std::uint8_t byte = 0;
    boost::system::error_code error;
    client.read_some(boost::asio::buffer(&byte, 1), error);
    return error == boost::asio::error::eof || error == boost::asio::error::connection_reset;
  }

  Line line_{
      {parse_module_spec("EX9042D-M@01")}, kInstant, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {}};
  boost::asio::io_context io_;
  StoredArrivals arrivals_;
  std::vector<std::string> notes_;
  ModbusTcpServer server_{io_, line_, {"127.0.0.1", 0}, kGatewayTimeout, [this](const std::string& text) {
                            notes_.push_back(text);
                          }};
};

TEST_F(ModbusTcpServerTest, AWrongHeaderEndsTheConnectionAfterTheRepliesToEarlierRequests) {
  tcp::socket client = connect();
  Buffer bytes = request(1);
  const Buffer wrong_protocol{0x00, 0x02, 0x00, 0x01, 0x00, 0x06, 0x01};
  bytes.insert(bytes.end(), wrong_protocol.begin(), wrong_protocol.end());
  send(client, bytes);
  wait_for_arrival(bytes.size());
  pass();
  EXPECT_EQ(receive(client, 11), reply(1));
  EXPECT_TRUE(closed(client));
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_EQ(notes_[0].rfind("the Modbus TCP gateway closes a connection: a client has sent a header ", 0), 0U)
      << notes_[0];
}

TEST_F(ModbusTcpServerTest, AClientThatHasClosedItsSendingSideGetsItsReplies) {
  tcp::socket client = connect();
  send(client, request(1));
  send(client, request(2));
  client.shutdown(tcp::socket::shutdown_send);
  wait_for_arrival(24);
  while (io_.run_one_for(std::chrono::milliseconds(0)) != 0) {
  }
  pass();
  EXPECT_EQ(receive(client, 11), reply(1));
  EXPECT_EQ(receive(client, 11), reply(2));
  EXPECT_TRUE(closed(client));
}

TEST_F(ModbusTcpServerTest, AClientThatDisappearsDoesNotAffectAnotherClient) {
  tcp::socket other = connect();
  {
    tcp::socket client = connect();
    send(client, request(1));
    send(client, request(2));
    wait_for_arrival(24);
    client.set_option(tcp::socket::linger(true, 0));  // the destructor sends a TCP reset
  }
  send(other, request(3));
  wait_for_arrival(36);
  pass();
  io_.poll();
  EXPECT_EQ(receive(other, 11), reply(3));
}

TEST_F(ModbusTcpServerTest, AClientBeyondTheLimitIsDisconnected) {
  std::vector<tcp::socket> clients;
  for (std::size_t i = 0; i < kMostClients; ++i) {
    clients.push_back(connect());
  }
  tcp::socket next = connect();
  boost::system::error_code error;
  std::uint8_t byte = 0;
  next.non_blocking(true);
  do {
    ASSERT_EQ(io_.run_one_for(std::chrono::seconds(60)), 1U);
    next.read_some(boost::asio::buffer(&byte, 1), error);
  } while (error == boost::asio::error::would_block);
  EXPECT_TRUE(error == boost::asio::error::eof || error == boost::asio::error::connection_reset) << error;
  EXPECT_EQ(notes_,
            std::vector<std::string>{"the Modbus TCP gateway refuses a client: 64 clients are connected, "
                                     "which is the maximum"});
  send(clients.back(), request(1));
  wait_for_arrival(12);
  pass();
  EXPECT_EQ(receive(clients.back(), 11), reply(1));
}

TEST_F(ModbusTcpServerTest, WhileTheLineAcceptsNoMoreBytesTheServerDoesNotReadFromAnyClient) {
  tcp::socket first = connect();
  tcp::socket second = connect();
  send(first, request(1));
  send(second, request(2));
  wait_for_arrival(24);  // both clients are connected, and the server waits for their next bytes
  io_.poll();
  arrivals_.pauses = true;
  send(first, request(3));
  wait_for_arrival(36);
  send(second, request(4));
  io_.poll();
  EXPECT_EQ(arrivals_.requested, 36U);
  arrivals_.pauses = false;
  server_.resume();
  wait_for_arrival(48);
}

TEST_F(ModbusTcpServerTest, AClientThatReadsLateGetsAllReplies) {
  constexpr std::uint8_t kNoUnit = 250;  // the gateway answers immediately with exception 0A
  constexpr std::size_t kRequest = 12;
  constexpr std::size_t kFarTooMuch = 50'000'000;
  tcp::socket client = connect(8192);
  client.non_blocking(true);
  std::size_t sent = 0;
  std::size_t requested_before = 0;
  boost::system::error_code error;
  do {
    ASSERT_LT(sent, kFarTooMuch) << "the server continues to read although the client does not read";
    requested_before = arrivals_.requested;
    Buffer requests;
    for (std::size_t i = sent / kRequest; i < sent / kRequest + 300; ++i) {
      const Buffer one = mbap_bytes({static_cast<std::uint16_t>(i), kNoUnit, kReadOutputs});
      requests.insert(requests.end(), one.begin(), one.end());
    }
    const std::size_t skipped = sent % kRequest;
    sent +=
        client.write_some(boost::asio::buffer(requests.data() + skipped, requests.size() - skipped), error);
    io_.poll();
    pass(VirtualTime(0));
  } while (!error || arrivals_.requested != requested_before);
  client.set_option(boost::asio::socket_base::receive_buffer_size(1'000'000));
  MbapReader replies;
  for (std::size_t received = 0; received < sent / kRequest;) {
    io_.poll();
    pass(VirtualTime(0));
    Buffer piece(4096);
    piece.resize(client.read_some(boost::asio::buffer(piece), error));
    ASSERT_TRUE(!error || error == boost::asio::error::would_block) << error;
    replies.add({piece.data(), piece.size()});
    while (const auto frame = replies.next()) {
      ASSERT_EQ(frame->transaction, static_cast<std::uint16_t>(received++));
      ASSERT_EQ(frame->unit, kNoUnit);
    }
  }
}

}  // namespace
}  // namespace ex9000::sim
