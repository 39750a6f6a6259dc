// Tests the settings of accepted connections, and the messages of ports that cannot listen.
#include "sim/files_and_ports/ports/listening.hpp"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>

namespace ex9000::sim {
namespace {

using boost::asio::ip::tcp;

TEST(Listening, AConnectionWithoutBytesIsProbedAfter30Seconds) {
  boost::asio::io_context io;
  tcp::socket socket(io, tcp::v4());
  keep_alive(socket);
  const auto value_of = [&socket](int level, int name) {
    int value = 0;
    socklen_t size = sizeof value;
    EXPECT_EQ(getsockopt(socket.native_handle(), level, name, &value, &size), 0);
    return value;
  };
  EXPECT_NE(value_of(SOL_SOCKET, SO_KEEPALIVE), 0);
  EXPECT_EQ(value_of(IPPROTO_TCP, TCP_KEEPIDLE), 30);
  EXPECT_EQ(value_of(IPPROTO_TCP, TCP_KEEPINTVL), 10);
  EXPECT_EQ(value_of(IPPROTO_TCP, TCP_KEEPCNT), 3);
}

TEST(Listening, TheAdviceFitsTheReason) {
  namespace errc = boost::system::errc;
  const auto message = [](errc::errc_t reason) {
    return why_not_listening(errc::make_error_code(reason), "name another port");
  };
  EXPECT_EQ(message(errc::address_in_use),
            "the port is in use; name another port, or end the program that uses it");
  EXPECT_EQ(message(errc::address_not_available), "Cannot assign requested address; name another port");
  EXPECT_EQ(message(errc::too_many_files_open),
            "Too many open files; raise the limit with 'ulimit -n', or use fewer lines");
  EXPECT_EQ(message(errc::too_many_files_open_in_system),
            "Too many open files in system; raise the limit with 'ulimit -n', or use fewer lines");
}

}  // namespace
}  // namespace ex9000::sim
