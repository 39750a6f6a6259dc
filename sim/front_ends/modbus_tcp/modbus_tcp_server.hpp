// Accepts the Modbus TCP clients of one line.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/files_and_ports/ports/tcp_server.hpp"
#include "sim/front_ends/modbus_tcp/gateway.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// A gateway to Modbus RTU, like a serial device server. Clients need not wait for replies before they send
/// more. After a wrong protocol or length, a client is disconnected when it has its earlier replies.
class ModbusTcpServer final : public TcpServer {
 public:
  /// One line, when a client is refused, or is disconnected because of its bytes.
  using Notice = std::function<void(const std::string& text)>;

  /// `line` must outlive this object. `timeout`: see `ask_on_line`.
  ModbusTcpServer(
      boost::asio::io_context& io, Line& line, const TcpAddress& address,
      VirtualTime timeout = kGatewayTimeout, Notice notice = [](const std::string& /*text*/) {})
      : TcpServer(io, address), line_(line), timeout_(timeout), notice_(std::move(notice)) {}

  [[nodiscard]] PortSummary summary() const override;
  void resume() override;
  /// Clients get only the replies to their own requests.
  std::size_t send(const std::vector<std::uint8_t>& /*bytes*/) override { return 0; }

 private:
  class Client;

  std::shared_ptr<TcpServer::Client> client_of(Socket socket) override;
  bool make_room() override;

  Line& line_;
  VirtualTime timeout_;
  Notice notice_;
  bool paused_ = false;
};

}  // namespace ex9000::sim
