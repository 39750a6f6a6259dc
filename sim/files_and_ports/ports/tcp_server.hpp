// How the TCP clients of a port come, wait and go.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/files_and_ports/ports/listening.hpp"
#include "sim/files_and_ports/ports/port.hpp"
#include "sim/files_and_ports/ports/tcp_address.hpp"

namespace ex9000::sim {

class TcpServer : public Port {
 public:
  ~TcpServer() override;

  void start(Arrivals& arrivals) final;
  void resume() override;
  void read_waiting() final;

 protected:
  using Socket = boost::asio::ip::tcp::socket;

  /// At the same time. Usually reached only if clients do not disconnect.
  static constexpr std::size_t kMostClients = 64;

  /// Shared by the server and pending operations: meanwhile, the server may remove it, or be destroyed. Then
  /// it is not connected, and handlers must do nothing.
  class Client : public std::enable_shared_from_this<Client> {
   public:
    Client(TcpServer& server, Socket socket) : socket_(std::move(socket)), server_(server) {}
    virtual ~Client() = default;

    [[nodiscard]] bool connected() const { return socket_.is_open(); }
    /// It has closed its sending side, and all its bytes have been read. It can still receive.
    [[nodiscard]] bool ended() const { return ended_; }
    /// Whenever bytes arrive, as long as `may_read`. Call it when that has become true.
    void read();
    virtual void resume() { read(); }
    void read_waiting();
    /// Returns how many bytes the client accepts now; nullopt: the connection has failed and is removed.
    std::optional<std::size_t> write(const std::vector<std::uint8_t>& bytes);
    /// The object remains until the functions that are running now have returned.
    void remove();
    void close();

   protected:
    [[nodiscard]] virtual bool may_read() const = 0;
    virtual void receive(Bytes bytes) = 0;
    /// `ended` has become true.
    virtual void end() = 0;

    [[nodiscard]] Port::Sender sender() const { return this; }

    Socket socket_;

   private:
    [[nodiscard]] bool can_read() const { return connected() && !ended_ && may_read(); }
    [[nodiscard]] boost::system::error_code take();

    TcpServer& server_;
    std::array<std::uint8_t, 4096> bytes_{};
    bool reading_ = false;  ///< the client waits for more bytes
    bool ended_ = false;
  };

  /// std::runtime_error: the address is not available.
  TcpServer(boost::asio::io_context& io, const TcpAddress& address);

  [[nodiscard]] std::string address() const;
  [[nodiscard]] Arrivals& arrivals() { return *arrivals_; }
  /// In the order of their connection.
  [[nodiscard]] const std::list<std::shared_ptr<Client>>& clients() const { return clients_; }

  virtual std::shared_ptr<Client> client_of(Socket socket) = 0;
  /// When one more than kMostClients comes: removes one, or returns false to refuse it.
  virtual bool make_room() = 0;

 private:
  boost::asio::io_context& io_;
  Listener<boost::asio::ip::tcp> listener_;
  Arrivals* arrivals_ = nullptr;  ///< null until `start`
  std::list<std::shared_ptr<Client>> clients_;
};

}  // namespace ex9000::sim
