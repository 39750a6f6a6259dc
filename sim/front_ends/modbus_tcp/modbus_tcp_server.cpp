#include "sim/front_ends/modbus_tcp/modbus_tcp_server.hpp"

#include <utility>
#include <vector>

#include "sim/front_ends/modbus_tcp/mbap_session.hpp"

namespace ex9000::sim {

namespace {

/// With so many bytes that wait to become requests, the server reads no more from a client. Not below
/// SteppedLine::kMostBytes, the largest N of `advance ... after N`.
constexpr std::size_t kMostUnread = 65536;

}  // namespace

class ModbusTcpServer::Client final : public TcpServer::Client {
 public:
  Client(ModbusTcpServer& server, Socket socket)
      : TcpServer::Client(server, std::move(socket)),
        server_(server),
        session_(
            server.line_, [this] { go_on(); }, server.timeout_) {}

 private:
  /// A client must accept its replies before it can send more requests.
  [[nodiscard]] bool may_read() const override {
    return !server_.paused_ && !session_.broken() && session_.unread() < kMostUnread &&
           session_.replies.empty();
  }
  void receive(Bytes bytes) override;
  void end() override { go_on(); }
  void go_on();

  ModbusTcpServer& server_;
  std::size_t arriving_ = 0;  ///< calls of `receive` whose bytes the session has not got yet
  bool writing_ = false;      ///< waits until the client accepts more replies
  MbapSession session_;
};

void ModbusTcpServer::Client::receive(Bytes bytes) {
  ++arriving_;
  const auto process = [this, self = shared_from_this(),
                        piece = std::vector<std::uint8_t>(bytes.begin(), bytes.end())] {
    --arriving_;
    if (connected()) {
      session_.receive({piece.data(), piece.size()});
      go_on();
    }
  };
  server_.paused_ = !server_.arrivals().requests(bytes.size, process);
}

/// Writes replies; then reads on, or disconnects a client that can send no more, after its last answer.
void ModbusTcpServer::Client::go_on() {
  if (!connected() || writing_) {
    return;
  }
  const auto written = write(session_.replies);
  if (!written) {
    return;
  }
  const auto begin = session_.replies.begin();
  session_.replies.erase(begin, begin + static_cast<std::ptrdiff_t>(*written));
  if (!session_.replies.empty()) {
    writing_ = true;
    socket_.async_wait(Socket::wait_write,
                       [this, self = shared_from_this()](const boost::system::error_code& /*error*/) {
                         writing_ = false;
                         go_on();
                       });
  } else if (!ended() && !session_.broken()) {
    read();
  } else if (arriving_ == 0 && session_.idle()) {
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
