// Helpers for servers that listen on this machine.
#pragma once

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <string>
#include <utility>

namespace ex9000::sim {

/// Opens `acceptor` and listens on `endpoint`. If that fails, returns the error and does not change
/// `acceptor`.
inline boost::system::error_code listen_at(boost::asio::ip::tcp::acceptor& acceptor,
                                           const boost::asio::ip::tcp::endpoint& endpoint) {
  // Connections of a process that has ended may still exist. They must not prevent this process from
  // listening.
  constexpr bool kReuseAddress = true;
  try {
    acceptor = boost::asio::ip::tcp::acceptor(acceptor.get_executor(), endpoint, kReuseAddress);
    return {};
  } catch (const boost::system::system_error& error) {
    return error.code();
  }
}

/// Calls `admit` with the socket of each new connection. To end this, close or destroy `acceptor`, and cancel
/// or destroy `next_try`. After an error, accepts again after 100 ms: if the process has no free file
/// descriptor, immediate retries would use all of the processor's time.
template <class Acceptor, class Admit>
void keep_accepting(Acceptor& acceptor, boost::asio::steady_timer& next_try, Admit admit) {
  using Socket = typename Acceptor::protocol_type::socket;
  acceptor.async_accept([&acceptor, &next_try, admit](const boost::system::error_code& error, Socket socket) {
    if (!error) {
      admit(std::move(socket));
      keep_accepting(acceptor, next_try, admit);
    } else if (error != boost::asio::error::operation_aborted) {
      next_try.expires_after(std::chrono::milliseconds(100));
      next_try.async_wait([&acceptor, &next_try, admit](const boost::system::error_code& aborted) {
        if (!aborted && acceptor.is_open()) {
          keep_accepting(acceptor, next_try, admit);
        }
      });
    }
  });
}

/// Makes the kernel probe the client, so that a client that has disappeared without a word frees its place:
/// after 30 s without a byte, every 10 s, until three probes have no answer. By default the kernel waits two
/// hours.
inline void keep_alive(boost::asio::ip::tcp::socket& socket) {
  const auto set = [&socket](int level, int name, int value) {
    setsockopt(socket.native_handle(), level, name, &value, sizeof value);
  };
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 30);
  set(IPPROTO_TCP, TCP_KEEPINTVL, 10);
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
}

/// Returns a text for the error, with advice for the user. The advice is `mend`, unless the port is in use,
/// or the process or the system has no free file descriptor.
inline std::string why_not_listening(const boost::system::error_code& error, const std::string& mend) {
  if (error == boost::system::errc::address_in_use) {
    return "the port is in use; name another port, or end the program that uses it";
  }
  const bool no_files = error == boost::system::errc::too_many_files_open ||
                        error == boost::system::errc::too_many_files_open_in_system;
  return error.message() + "; " + (no_files ? "raise the limit with 'ulimit -n', or use fewer lines" : mend);
}

}  // namespace ex9000::sim
