// Transfers the bytes of a line over TCP, like a serial device server.
#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "sim/files_and_ports/ports/tcp_server.hpp"

namespace ex9000::sim {

/// Transfers only the bytes: no MBAP header, no telnet negotiation. The port sends the bytes from the line to
/// all clients, and passes the bytes of each client to the line.
class TcpPort final : public TcpServer {
 public:
  /// A client that has closed its sending side can still receive replies. The port keeps such a client for
  /// this time, or for up to twice this time if it must wait for `resume`; nullopt: forever. After this time,
  /// or after a reset of the connection, the client has left: see Arrivals::left.
  using Linger = std::optional<std::chrono::milliseconds>;
  static constexpr std::chrono::milliseconds kUsualLinger{1000};

  /// See TcpServer::TcpServer.
  TcpPort(boost::asio::io_context& io, const TcpAddress& address, Linger linger)
      : TcpServer(io, address), io_(io), linger_(linger) {}

  [[nodiscard]] PortSummary summary() const override;
  std::size_t send(const std::vector<std::uint8_t>& bytes) override;

 private:
  class Client;

  std::shared_ptr<TcpServer::Client> client_of(Socket socket) override;
  bool make_room() override;

  boost::asio::io_context& io_;
  Linger linger_;
};

}  // namespace ex9000::sim
