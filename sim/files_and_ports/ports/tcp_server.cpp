#include "sim/files_and_ports/ports/tcp_server.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/post.hpp>
#include <sstream>
#include <utility>

#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;

std::string text_of(const tcp::endpoint& endpoint) {
  std::ostringstream text;
  text << endpoint;
  return text.str();
}

}  // namespace

TcpServer::TcpServer(boost::asio::io_context& io, const TcpAddress& address) : io_(io), listener_(io) {
  const tcp::endpoint endpoint(boost::asio::ip::make_address(address.host), address.port);
  if (const error_code error = listener_.listen(endpoint)) {
    unavailable(text_of(endpoint) + ": " +
                why_not_listening(error, "name an address and a free port of this machine"));
  }
}

TcpServer::~TcpServer() {
  for (const auto& client : clients_) {
    client->close();
  }
}

std::string TcpServer::address() const { return text_of(listener_.endpoint()); }

void TcpServer::start(Arrivals& arrivals) {
  arrivals_ = &arrivals;
  listener_.start([this](Socket socket) {
    if (clients_.size() < kMostClients || make_room()) {
      clients_.push_back(client_of(std::move(socket)));
      let_line_go(*arrivals_);
      clients_.back()->read();
    }
  });
}

void TcpServer::resume() {
  for (const auto& client : clients_) {
    client->resume();
  }
}

void TcpServer::read_waiting() {
  listener_.accept_waiting();
  const auto clients = clients_;  // a reply can fail, and remove a client
  for (const auto& client : clients) {
    client->read_waiting();
  }
}

void TcpServer::Client::read() {
  if (reading_ || !can_read()) {
    return;
  }
  reading_ = true;
  socket_.async_wait(Socket::wait_read, [this, self = shared_from_this()](const error_code& error) {
    reading_ = false;
    if (!can_read()) {
      return;  // this has changed during the wait
    }
    const error_code failed = error ? error : take();
    if (!failed || failed == boost::asio::error::would_block) {
      read();
    } else if (failed == boost::asio::error::eof) {
      ended_ = true;
      end();
    } else {
      remove();
    }
  });
}

/// Errors are handled later, when the io_context runs.
void TcpServer::Client::read_waiting() {
  while (can_read() && !take()) {
  }
}

/// At most the size of `bytes_`; an error if no bytes are available.
error_code TcpServer::Client::take() {
  error_code error;
  const std::size_t size = socket_.read_some(boost::asio::buffer(bytes_), error);
  if (!error) {
    receive({bytes_.data(), size});
  }
  return error;
}

std::optional<std::size_t> TcpServer::Client::write(const std::vector<std::uint8_t>& bytes) {
  error_code error;
  const std::size_t written = socket_.write_some(boost::asio::buffer(bytes), error);
  if (error && error != boost::asio::error::would_block) {
    remove();
    return std::nullopt;
  }
  return written;
}

/// First reads and drops up to 256 KiB that have arrived: with bytes unread, the close would reset the
/// connection, and the client could lose its last replies.
void TcpServer::Client::remove() {
  if (!connected()) {
    return;
  }
  constexpr int kMostPieces = 64;
  error_code ended;
  for (int i = 0; i < kMostPieces && !ended; ++i) {
    socket_.read_some(boost::asio::buffer(bytes_), ended);
  }
  close();
  const auto self = shared_from_this();
  boost::asio::post(server_.io_, [self] {});
  server_.arrivals_->left(sender());
  server_.clients_.remove(self);
}

void TcpServer::Client::close() {
  error_code ignored;
  socket_.close(ignored);
}

}  // namespace ex9000::sim
