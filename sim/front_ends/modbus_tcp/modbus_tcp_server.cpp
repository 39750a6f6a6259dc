#include "sim/front_ends/modbus_tcp/modbus_tcp_server.hpp"

#include <boost/asio/socket_base.hpp>
#include <functional>
#include <utility>

#include "sim/front_ends/modbus_tcp/mbap_session.hpp"

namespace ex9000::sim {

namespace {

/// The server does not read from a client while at least this many bytes of the client wait to become
/// requests. The limit is not lower than SteppedLine::kMostBytes, the largest N of `advance ... after N`.
constexpr std::size_t kMostUnread = 65536;
/// The size of the send buffer of each client, in bytes. When the buffer of a client that does not read is
/// full, the server passes on no more requests of this client.
constexpr int kMostUnsent = 65536;

}  // namespace

class ModbusTcpServer::Client final : public TcpServer::Client {
 public:
  Client(ModbusTcpServer& server, Socket socket)
      : TcpServer::Client(server, std::move(socket)),
        server_(server),
        session_(
            server.line_,
            [this](const std::vector<std::uint8_t>& reply) {
              replies_.insert(replies_.end(), reply.begin(), reply.end());
              return send_replies();
            },
            [this] { go_on(); }, server.timeout_) {
    boost::system::error_code ignored;
    socket_.set_option(boost::asio::socket_base::send_buffer_size(kMostUnsent), ignored);
  }

 private:
  [[nodiscard]] bool may_read() const override {
    return !server_.paused_ && !session_.broken() && session_.unread() < kMostUnread;
  }
  void receive(Bytes bytes) override {
    deliver(bytes.size, [this, piece = std::vector<std::uint8_t>(bytes.begin(), bytes.end())] {
      session_.receive({piece.data(), piece.size()});
    });
  }
  void end() override { go_on(); }

  void deliver(std::size_t size, const std::function<void()>& action);
  bool send_replies();
  void go_on();

  ModbusTcpServer& server_;
  std::size_t arriving_ = 0;           ///< calls of `deliver` whose `action` has not run yet
  std::vector<std::uint8_t> replies_;  ///< bytes that the client has not accepted yet
  bool writing_ = false;               ///< an asynchronous wait is pending
  MbapSession session_;
};

/// When the line is ready, runs `action`, unless the client has been removed meanwhile.
void ModbusTcpServer::Client::deliver(std::size_t size, const std::function<void()>& action) {
  ++arriving_;
  server_.paused_ = !server_.arrivals().requests(size, [this, self = shared_from_this(), action] {
    --arriving_;
    if (connected()) {
      action();
      go_on();
    }
  });
}

/// Writes the replies that the client accepts now, and the rest when the client accepts more. Returns whether
/// all replies have been written.
bool ModbusTcpServer::Client::send_replies() {
  if (writing_ || !connected()) {
    return false;
  }
  const auto written = write(replies_);
  if (!written) {
    return false;
  }
  const auto begin = replies_.begin();
  replies_.erase(begin, begin + static_cast<std::ptrdiff_t>(*written));
  if (replies_.empty()) {
    return true;
  }
  writing_ = true;
  socket_.async_wait(Socket::wait_write,
                     [this, self = shared_from_this()](const boost::system::error_code& /*error*/) {
                       writing_ = false;
                       if (send_replies()) {
                         deliver(0, [this] { session_.resume(); });
                       }
                     });
  return false;
}

/// Reads from the client again if it can send more requests. Otherwise, disconnects it when all its replies
/// have been written.
void ModbusTcpServer::Client::go_on() {
  if (!ended() && !session_.broken()) {
    read();
  } else if (connected() && arriving_ == 0 && session_.idle() && replies_.empty()) {
    if (session_.broken()) {
      server_.notice_(
          "the Modbus TCP gateway closes a connection: a client has sent a header whose protocol is not 0 or "
          "whose length is not 2 to 254; if it sends Modbus RTU or ASCII over TCP, use --port tcp:...");
    }
    remove();
  }
}

PortSummary ModbusTcpServer::summary() const {
  return {"modbus-tcp", address(),
          "Modbus TCP " + address() + ", a gateway to the modules that speak Modbus RTU"};
}

std::shared_ptr<TcpServer::Client> ModbusTcpServer::client_of(Socket socket) {
  return std::make_shared<Client>(*this, std::move(socket));
}

bool ModbusTcpServer::make_room() {
  notice_("the Modbus TCP gateway refuses a client: " + std::to_string(kMostClients) +
          " clients are connected, which is the maximum");
  return false;
}

void ModbusTcpServer::resume() {
  paused_ = false;
  TcpServer::resume();
}

}  // namespace ex9000::sim
