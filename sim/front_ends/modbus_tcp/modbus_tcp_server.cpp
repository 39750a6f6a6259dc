#include "sim/front_ends/modbus_tcp/modbus_tcp_server.hpp"

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <utility>
#include <vector>

#include "sim/front_ends/modbus_tcp/mbap_session.hpp"

namespace ex9000::sim {

namespace {

using boost::asio::ip::tcp;

/// The maximum number of clients. The server disconnects each further client.
constexpr std::size_t kMostClients = 64;
/// The server does not read from a client while at least this many bytes of the client wait to become
/// requests. The limit is not lower than SteppedLine::kMostBytes, the largest N of `advance ... after N`.
constexpr std::size_t kMostUnread = 65536;
/// The size of the send buffer of each client, in bytes. When the buffer of a client that does not read is
/// full, the server passes on no more requests of this client.
constexpr int kMostUnsent = 65536;

}  // namespace

struct ModbusTcpServer::Client : std::enable_shared_from_this<Client> {
  Client(ModbusTcpServer& server, tcp::socket its_socket)
      : socket(std::move(its_socket)),
        session(
            server.line_,
            [this, &server](const std::vector<std::uint8_t>& reply) {
              replies.insert(replies.end(), reply.begin(), reply.end());
              return server.write(shared_from_this());
            },
            [this, &server] { server.go_on(shared_from_this()); }, server.timeout_) {}

  /// Returns whether the server may read more bytes of this client. Does not consider `paused_`.
  [[nodiscard]] bool may_read() const {
    return socket.is_open() && !ended && !session.broken() && session.unread() < kMostUnread;
  }

  tcp::socket socket;
  std::array<std::uint8_t, 4096> bytes{};
  std::size_t arriving = 0;           ///< calls of `deliver` whose `action` has not run yet
  std::vector<std::uint8_t> replies;  ///< bytes that the client has not accepted yet
  bool reading = false;               ///< an asynchronous read is pending
  bool writing = false;               ///< an asynchronous write is pending
  bool ended = false;                 ///< the client sends nothing more
  MbapSession session;
};

ModbusTcpServer::ModbusTcpServer(boost::asio::io_context& io, Line& line, const TcpAddress& address,
                                 VirtualTime timeout, Notice notice)
    : io_(io), line_(line), timeout_(timeout), notice_(std::move(notice)), listener_(io, address) {}

ModbusTcpServer::~ModbusTcpServer() {
  for (const ClientPointer& client : clients_) {
    boost::system::error_code ignored;
    client->socket.close(ignored);
  }
}

PortSummary ModbusTcpServer::summary() const {
  return {"modbus-tcp", listener_.address(),
          "Modbus TCP " + listener_.address() + ", a gateway to the modules that speak Modbus RTU"};
}

void ModbusTcpServer::start(Arrivals& arrivals) {
  arrivals_ = &arrivals;
  listener_.start([this](tcp::socket socket) { admit(std::move(socket)); });
}

void ModbusTcpServer::admit(tcp::socket socket) {
  if (clients_.size() < kMostClients) {
    boost::system::error_code ignored;
    socket.set_option(tcp::socket::send_buffer_size(kMostUnsent), ignored);
    clients_.push_back(std::make_shared<Client>(*this, std::move(socket)));
    let_line_go(*arrivals_);
    read(clients_.back());
  } else {
    notice_("the Modbus TCP gateway refuses a client: " + std::to_string(kMostClients) +
            " clients are connected, which is the maximum");
  }
}

void ModbusTcpServer::resume() {
  paused_ = false;
  for (const ClientPointer& client : clients_) {
    read(client);
  }
}

/// Errors of a client are handled later, when the io_context runs.
void ModbusTcpServer::read_waiting() {
  listener_.accept_waiting();
  const std::list<ClientPointer> clients = clients_;
  for (const ClientPointer& client : clients) {
    while (!paused_ && client->may_read() && !take(client)) {
    }
  }
}

void ModbusTcpServer::read(const ClientPointer& client) {
  if (client->reading || paused_ || !client->may_read()) {
    return;
  }
  client->reading = true;
  client->socket.async_wait(tcp::socket::wait_read, [this, client](const boost::system::error_code& error) {
    if (!client->socket.is_open()) {
      return;  // the client was removed, or the server was destroyed
    }
    client->reading = false;
    if (paused_ || !client->may_read()) {
      return;  // during the wait, the server was paused, or `may_read` became false
    }
    const boost::system::error_code ended = error ? error : take(client);
    if (ended == boost::asio::error::eof) {
      client->ended = true;
      go_on(client);
    } else if (ended && ended != boost::asio::error::would_block) {
      forget(client);
    } else {
      read(client);
    }
  });
}

/// Reads the available bytes, up to the size of `client->bytes`, and delivers them. Returns the error if no
/// bytes are available.
boost::system::error_code ModbusTcpServer::take(const ClientPointer& client) {
  boost::system::error_code error;
  const std::size_t size = client->socket.read_some(boost::asio::buffer(client->bytes), error);
  if (!error) {
    const auto begin = client->bytes.begin();
    deliver(client, size,
            [client, piece = std::vector<std::uint8_t>(begin, begin + static_cast<std::ptrdiff_t>(size))] {
              client->session.receive({piece.data(), piece.size()});
            });
  }
  return error;
}

/// When the line is ready, runs `action`, unless the client has been removed meanwhile.
void ModbusTcpServer::deliver(const ClientPointer& client, std::size_t size,
                              const std::function<void()>& action) {
  ++client->arriving;
  paused_ = !arrivals_->requests(size, [this, client, action] {
    --client->arriving;
    if (client->socket.is_open()) {
      action();
      go_on(client);
    }
  });
}

/// Writes the replies that the client accepts now, and the rest when the client accepts more. Returns whether
/// all replies have been written.
bool ModbusTcpServer::write(const ClientPointer& client) {
  if (client->writing || !client->socket.is_open()) {
    return false;
  }
  boost::system::error_code error;
  const std::size_t written = client->socket.write_some(boost::asio::buffer(client->replies), error);
  if (error && error != boost::asio::error::would_block) {
    forget(client);
    return false;
  }
  const auto begin = client->replies.begin();
  client->replies.erase(begin, begin + static_cast<std::ptrdiff_t>(written));
  if (client->replies.empty()) {
    return true;
  }
  client->writing = true;
  client->socket.async_wait(tcp::socket::wait_write, [this, client](const boost::system::error_code& failed) {
    if (!client->socket.is_open()) {
      return;
    }
    client->writing = false;
    if (failed) {
      forget(client);
    } else if (write(client)) {
      deliver(client, 0, [client] { client->session.resume(); });
    }
  });
  return false;
}

/// Reads from the client again if it can send more requests. Otherwise, disconnects it when all its replies
/// have been written.
void ModbusTcpServer::go_on(const ClientPointer& client) {
  const bool sends_no_more = client->ended || client->session.broken();
  if (!sends_no_more) {
    read(client);
  } else if (client->arriving == 0 && client->session.idle() && client->replies.empty()) {
    if (client->session.broken() && client->socket.is_open()) {
      notice_(
          "the Modbus TCP gateway closes a connection: a client has sent a header whose protocol is not 0 or "
          "whose "
          "length is not 2 to 254; if it sends Modbus RTU or ASCII over TCP, use --port tcp:...");
    }
    forget(client);
  }
}

/// Closes the connection. Before that, reads and drops the bytes that have already arrived, at most 256 KiB:
/// if unread bytes were left, the close would reset the connection, and the client could lose its last
/// replies. The Client object remains until the functions that are running now have returned.
void ModbusTcpServer::forget(const ClientPointer& client) {
  constexpr int kMostPieces = 64;
  boost::system::error_code ended;
  for (int i = 0; i < kMostPieces && !ended; ++i) {
    client->socket.read_some(boost::asio::buffer(client->bytes), ended);
  }
  boost::system::error_code ignored;
  client->socket.close(ignored);
  boost::asio::post(io_, [client] {});
  clients_.remove(client);
}

}  // namespace ex9000::sim
