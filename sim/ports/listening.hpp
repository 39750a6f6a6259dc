// Helpers for listening on a TCP port of this machine.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <string>

namespace ex9000::sim {

/// Opens `acceptor` on `endpoint`. If that fails, closes it again and returns the error.
inline boost::system::error_code listen_at(boost::asio::ip::tcp::acceptor& acceptor,
                                           const boost::asio::ip::tcp::endpoint& endpoint) {
  using boost::asio::ip::tcp;
  boost::system::error_code error;
  acceptor.open(endpoint.protocol(), error);
  // Lingering connections of a dead process must not prevent this one from listening.
  if (!error) {
    acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  }
  if (!error) {
    acceptor.bind(endpoint, error);
  }
  if (!error) {
    acceptor.listen(tcp::acceptor::max_listen_connections, error);
  }
  if (error) {
    boost::system::error_code ignored;
    acceptor.close(ignored);
  }
  return error;
}

/// Describes the error; adds `mend` unless another program uses the port.
inline std::string why_not_listening(const boost::system::error_code& error, const std::string& mend) {
  return error == boost::asio::error::address_in_use
             ? "another program listens there; end it or name another port"
             : error.message() + "; " + mend;
}

}  // namespace ex9000::sim
