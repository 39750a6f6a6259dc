#include "sim/files_and_ports/ports/tcp_port.hpp"

#include <poll.h>

#include <algorithm>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <utility>

namespace ex9000::sim {

class TcpPort::Client final : public TcpServer::Client {
 public:
  Client(TcpPort& port, Socket socket)
      : TcpServer::Client(port, std::move(socket)), port_(port), linger_(port.io_) {}

  void resume() override {
    paused_ = false;
    read();
  }

 private:
  [[nodiscard]] bool may_read() const override { return !paused_; }
  void receive(Bytes bytes) override {
    paused_ = !port_.arrivals().bytes(port_, bytes, {}, sender());
    if (paused_ && linger_.expiry() <= std::chrono::steady_clock::now()) {
      linger();  // unless it waits already, from an earlier pause
    }
  }
  void end() override { linger(); }
  void linger();
  [[nodiscard]] bool peer_has_closed();

  TcpPort& port_;
  boost::asio::steady_timer linger_;
  bool paused_ = false;
};

/// Removes the client after the linger time if it has closed its sending side by now, and still has nothing
/// to read. While it is paused, unread bytes hide the end of the stream, so this looks again each time.
void TcpPort::Client::linger() {
  if (!port_.linger_ || !connected()) {
    return;
  }
  linger_.expires_after(*port_.linger_);
  linger_.async_wait([this, self = shared_from_this(),
                      had_closed = peer_has_closed()](const boost::system::error_code& error) {
    if (error || !connected() || !(ended() || paused_)) {
      return;
    }
    if (had_closed) {
      remove();
    } else {
      linger();
    }
  });
}

bool TcpPort::Client::peer_has_closed() {
  pollfd client{socket_.native_handle(), POLLRDHUP, 0};
  return poll(&client, 1, 0) == 1;
}

PortSummary TcpPort::summary() const {
  return {"tcp", address(), "TCP " + address() + ", raw bytes: Modbus RTU (not Modbus TCP) and ASCII"};
}

std::shared_ptr<TcpServer::Client> TcpPort::client_of(Socket socket) {
  return std::make_shared<Client>(*this, std::move(socket));
}

bool TcpPort::make_room() {
  const auto lingers =
      std::find_if(clients().begin(), clients().end(), [](const auto& client) { return client->ended(); });
  if (lingers == clients().end()) {
    return false;
  }
  (*lingers)->remove();
  return true;
}

std::size_t TcpPort::send(const std::vector<std::uint8_t>& bytes) {
  std::size_t dropped = 0;
  for (auto next = clients().begin(); next != clients().end();) {
    TcpServer::Client& client = **next++;  // `write` may remove it
    dropped = std::max(dropped, bytes.size() - client.write(bytes).value_or(bytes.size()));
  }
  return dropped;
}

}  // namespace ex9000::sim
