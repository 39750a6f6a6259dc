// Transfers the bytes of a line over TCP, like a serial device server.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <list>
#include <memory>
#include <optional>
#include <string>

#include "sim/files_and_ports/ports/port.hpp"
#include "sim/files_and_ports/ports/tcp_listener.hpp"

namespace ex9000::sim {

/// Transfers only the bytes: no MBAP header, no telnet negotiation. The port sends the bytes from the line to
/// all clients, and passes the bytes of each client to the line.
class TcpPort final : public Port {
 public:
  /// A client that has closed its sending side can still receive replies. The port keeps such a client for
  /// this time, or for up to twice this time if it must wait for `resume`; nullopt: forever. After this time,
  /// or after a reset of the connection, the client has left: see Arrivals::left.
  using Linger = std::optional<std::chrono::milliseconds>;
  static constexpr std::chrono::milliseconds kUsualLinger{1000};

  /// Starts to listen. Throws std::runtime_error with a one-line message if the address is not available.
  TcpPort(boost::asio::io_context& io, const TcpAddress& address, Linger linger);
  ~TcpPort() override;

  [[nodiscard]] PortSummary summary() const override;
  void start(Arrivals& arrivals) override;
  void resume() override;
  void read_waiting() override;
  std::size_t send(const std::vector<std::uint8_t>& bytes) override;

 private:
  struct Client;

  void admit(boost::asio::ip::tcp::socket socket);
  /// The port and pending asynchronous operations share a client, because the port may remove the client
  /// while an operation is pending.
  using ClientPointer = std::shared_ptr<Client>;

  void read(const ClientPointer& client);
  [[nodiscard]] boost::system::error_code take(Client& client);
  void watch_paused(const ClientPointer& client);
  void let_linger(const ClientPointer& client);
  void forget(const ClientPointer& client);

  boost::asio::io_context& io_;
  TcpListener listener_;
  Linger linger_;
  Arrivals* arrivals_ = nullptr;  ///< null until `start`
  std::list<ClientPointer> clients_;
};

}  // namespace ex9000::sim
