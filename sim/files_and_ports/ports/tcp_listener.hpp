// Listens on a TCP address and accepts clients.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <string>

#include "sim/files_and_ports/ports/tcp_address.hpp"

namespace ex9000::sim {

/// None of the functions blocks.
class TcpListener {
 public:
  /// Receives the socket of each client. The socket does not block, sends without delay (TCP_NODELAY), and
  /// detects clients that have disappeared (SO_KEEPALIVE).
  using Admit = std::function<void(boost::asio::ip::tcp::socket socket)>;

  /// Starts to listen. Throws std::runtime_error with a one-line message if the address is not available.
  TcpListener(boost::asio::io_context& io, const TcpAddress& address);

  /// Calls `admit` for each client while the io_context runs. Call this once.
  void start(Admit admit);
  /// Before this function returns, it calls `admit` for all clients that wait to be accepted. The io_context
  /// does not have to run. Call this only after `start`.
  void accept_waiting();
  /// Returns the HOST:PORT on which this object listens.
  [[nodiscard]] std::string address() const;

 private:
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer next_try_;
  Admit admit_;
};

}  // namespace ex9000::sim
