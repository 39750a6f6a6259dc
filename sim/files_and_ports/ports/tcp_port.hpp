// Transfers the bytes of a line over TCP, like a serial device server.
#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "sim/files_and_ports/ports/tcp_server.hpp"

namespace ex9000::sim {

/// Only the bytes: no MBAP header, no telnet negotiation. Bytes from the line go to all clients.
class TcpPort final : public TcpServer {
 public:
  /// How long a client that has closed its sending side still gets replies, up to twice that if it must wait
  /// for `resume`; nullopt: forever. Then, or at a reset of the connection, it has left (Arrivals::left).
  using Linger = std::optional<std::chrono::milliseconds>;
  static constexpr std::chrono::milliseconds kUsualLinger{1000};

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
