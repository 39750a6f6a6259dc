#include "sim/files_and_ports/ports/tcp_port.hpp"

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <utility>

namespace ex9000::sim {

namespace {

using boost::asio::ip::tcp;

/// The maximum number of clients at the same time. Usually, this number is reached only if clients do not
/// disconnect.
constexpr std::size_t kMostMasters = 64;

}  // namespace

struct TcpPort::Client {
  Client(boost::asio::io_context& io, tcp::socket its_socket) : socket(std::move(its_socket)), linger(io) {}

  tcp::socket socket;
  boost::asio::steady_timer linger;
  /// Closes the socket and cancels pending operations. The handlers of cancelled operations do nothing.
  void close() {
    boost::system::error_code ignored;
    linger.cancel(ignored);
    socket.close(ignored);
  }

  [[nodiscard]] bool peer_has_closed() {
    tcp_info info{};
    socklen_t size = sizeof info;
    return getsockopt(socket.native_handle(), IPPROTO_TCP, TCP_INFO, &info, &size) == 0 &&
           (info.tcpi_state == TCP_CLOSE_WAIT || info.tcpi_state == TCP_CLOSE);
  }

  std::array<std::uint8_t, 4096> bytes{};
  bool reading = false;  ///< the port waits for more bytes from the client
  bool paused = false;
  bool lingers = false;  ///< the client has closed its sending side
  bool watched = false;  ///< see `watch_paused`
  bool closing = false;  ///< the client has closed its sending side; see `watch_paused`
};

TcpPort::TcpPort(boost::asio::io_context& io, const TcpAddress& address, Linger linger)
    : io_(io), listener_(io, address), linger_(linger) {}

TcpPort::~TcpPort() {
  for (const ClientPointer& client : clients_) {
    client->close();
  }
}

PortSummary TcpPort::summary() const {
  return {"tcp", listener_.address(),
          "TCP " + listener_.address() + ", raw bytes: Modbus RTU (not Modbus TCP) and ASCII"};
}

void TcpPort::start(Arrivals& arrivals) {
  arrivals_ = &arrivals;
  listener_.start([this](tcp::socket socket) { admit(std::move(socket)); });
}

/// If the limit is reached, removes the lingering client that connected first, or rejects the new client if
/// no client lingers.
void TcpPort::admit(tcp::socket socket) {
  if (clients_.size() >= kMostMasters) {
    const auto oldest =
        std::find_if(clients_.begin(), clients_.end(), [](const auto& client) { return client->lingers; });
    if (oldest == clients_.end()) {
      return;
    }
    forget(ClientPointer(*oldest));
  }
  clients_.push_back(std::make_shared<Client>(io_, std::move(socket)));
  let_line_go(*arrivals_);
  read(clients_.back());
}

/// Errors of a client are handled later, when the io_context runs.
void TcpPort::read_waiting() {
  listener_.accept_waiting();
  const std::list<ClientPointer> clients = clients_;
  for (const ClientPointer& client : clients) {
    while (!client->paused && !take(*client)) {
    }
  }
}

/// Reads the available bytes, up to the size of `client.bytes`, and delivers them. Returns the
/// error if no bytes are available.
boost::system::error_code TcpPort::take(Client& client) {
  boost::system::error_code error;
  const std::size_t size = client.socket.read_some(boost::asio::buffer(client.bytes), error);
  if (!error) {
    client.paused = !arrivals_->bytes(*this, {client.bytes.data(), size}, {}, &client);
  }
  return error;
}

void TcpPort::read(const ClientPointer& client) {
  if (client->reading || client->paused) {
    return;
  }
  client->reading = true;
  client->socket.async_wait(tcp::socket::wait_read, [this, client](const boost::system::error_code& error) {
    if (!client->socket.is_open()) {
      return;  // the client was removed, or the port was destroyed
    }
    client->reading = false;
    if (client->paused) {
      return;  // the client was paused during the wait
    }
    const boost::system::error_code ended = error ? error : take(*client);
    watch_paused(client);
    if (!ended || ended == boost::asio::error::would_block) {
      read(client);
    } else if (ended == boost::asio::error::eof) {
      let_linger(client);
    } else {
      forget(client);
    }
  });
}

void TcpPort::resume() {
  for (const ClientPointer& client : clients_) {
    client->paused = false;
    if (!client->lingers) {
      read(client);
    }
  }
}

/// Removes a client that has closed its sending side while the port reads none of its bytes: its unread bytes
/// hide the end of the stream. Looks once in each linger time, and removes the client at the second look at
/// which it has closed.
void TcpPort::watch_paused(const ClientPointer& client) {
  if (!linger_ || client->watched || !client->paused) {
    return;
  }
  client->watched = true;
  client->linger.expires_after(*linger_);
  client->linger.async_wait([this, client](const boost::system::error_code& error) {
    client->watched = false;
    if (error || !client->socket.is_open()) {
      return;
    }
    const bool closed_before = std::exchange(client->closing, client->peer_has_closed());
    if (client->paused && client->closing && closed_before) {
      forget(client);
    } else {
      watch_paused(client);
    }
  });
}

/// Keeps a client that has closed its sending side, because the client may still receive. If there is a
/// linger time, removes the client after this time.
void TcpPort::let_linger(const ClientPointer& client) {
  client->lingers = true;
  if (!linger_) {
    return;
  }
  client->linger.expires_after(*linger_);
  client->linger.async_wait([this, client](const boost::system::error_code& /*error*/) {
    if (client->socket.is_open()) {  // otherwise the client was removed, or the port was destroyed
      forget(client);
    }
  });
}

void TcpPort::forget(const ClientPointer& client) {
  client->close();
  arrivals_->left(client.get());
  clients_.remove(client);
}

std::size_t TcpPort::send(const std::vector<std::uint8_t>& bytes) {
  std::size_t dropped = 0;
  clients_.remove_if([&](const auto& client) {
    boost::system::error_code error;
    const std::size_t written = client->socket.write_some(boost::asio::buffer(bytes), error);
    const bool gone = error && error != boost::asio::error::would_block;
    dropped = std::max(dropped, gone ? 0 : bytes.size() - written);
    if (gone) {
      client->close();
      arrivals_->left(client.get());
    }
    return gone;
  });
  return dropped;
}

}  // namespace ex9000::sim
