// Helpers for servers that listen on this machine.
#pragma once

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

/// Returns a text for the error, with advice for the user. The advice is `mend`, unless the port is in use.
inline std::string why_not_listening(const boost::system::error_code& error, const std::string& mend) {
  return error == boost::asio::error::address_in_use
             ? "the port is in use; name another port, or end the program that uses it"
             : error.message() + "; " + mend;
}

}  // namespace ex9000::sim
