#include "sim/files_and_ports/ports/tcp_listener.hpp"

#include <boost/asio/ip/address.hpp>
#include <utility>

#include "sim/files_and_ports/ports/listening.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

using boost::asio::ip::tcp;

std::string text_of(const std::string& host, std::uint16_t port) {
  return (host.find(':') == std::string::npos ? host : "[" + host + "]") + ":" + std::to_string(port);
}

}  // namespace

TcpListener::TcpListener(boost::asio::io_context& io, const TcpAddress& address)
    : acceptor_(io), next_try_(io) {
  boost::system::error_code error;
  const auto host = boost::asio::ip::make_address(address.host, error);
  if (!error) {
    error = listen_at(acceptor_, tcp::endpoint(host, address.port));
  }
  if (error) {
    unavailable(text_of(address.host, address.port) + ": " +
                why_not_listening(error, "name an address and a free port of this machine"));
  }
}

void TcpListener::start(Admit admit) {
  admit_ = [admit = std::move(admit)](tcp::socket socket) {
    boost::system::error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    keep_alive(socket);
    socket.non_blocking(true, ignored);
    admit(std::move(socket));
  };
  keep_accepting(acceptor_, next_try_, admit_);
}

void TcpListener::accept_waiting() {
  boost::system::error_code error;
  acceptor_.non_blocking(true, error);
  for (tcp::socket socket = acceptor_.accept(error); !error; socket = acceptor_.accept(error)) {
    admit_(std::move(socket));
  }
}

std::string TcpListener::address() const {
  const tcp::endpoint endpoint = acceptor_.local_endpoint();
  return text_of(endpoint.address().to_string(), endpoint.port());
}

}  // namespace ex9000::sim
