// Accepts the Modbus TCP clients of one line.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "sim/files_and_ports/ports/port.hpp"
#include "sim/files_and_ports/ports/tcp_address.hpp"
#include "sim/files_and_ports/ports/tcp_listener.hpp"
#include "sim/front_ends/modbus_tcp/gateway.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Receives requests over Modbus TCP and sends them on the line as Modbus RTU frames, like a serial device
/// server. Each client may send further requests before it has received its replies. A client that sends a
/// frame with a wrong protocol or length is disconnected after the replies to its earlier requests.
class ModbusTcpServer final : public Port {
 public:
  /// Receives a one-line message when the server refuses a client, or disconnects it because of its bytes.
  using Notice = std::function<void(const std::string& text)>;

  /// Starts to listen. Throws std::runtime_error with a one-line message if the address is not available.
  /// `line` must outlive this object. `timeout`: see `ask_on_line`.
  ModbusTcpServer(
      boost::asio::io_context& io, Line& line, const TcpAddress& address,
      VirtualTime timeout = kGatewayTimeout, Notice notice = [](const std::string& /*text*/) {});
  ~ModbusTcpServer() override;

  [[nodiscard]] PortSummary summary() const override;
  void start(Arrivals& arrivals) override;
  void resume() override;
  void read_waiting() override;
  /// Does nothing: clients get only the replies to their own requests.
  std::size_t send(const std::vector<std::uint8_t>& /*bytes*/) override { return 0; }

 private:
  struct Client;
  /// The server and pending asynchronous operations share a client.
  using ClientPointer = std::shared_ptr<Client>;

  void admit(boost::asio::ip::tcp::socket socket);
  void read(const ClientPointer& client);
  [[nodiscard]] boost::system::error_code take(const ClientPointer& client);
  void deliver(const ClientPointer& client, std::size_t size, const std::function<void()>& action);
  [[nodiscard]] bool write(const ClientPointer& client);
  void go_on(const ClientPointer& client);
  void forget(const ClientPointer& client);

  boost::asio::io_context& io_;
  Line& line_;
  VirtualTime timeout_;
  Notice notice_;
  TcpListener listener_;
  Arrivals* arrivals_ = nullptr;  ///< null until `start`
  bool paused_ = false;
  std::list<ClientPointer> clients_;
};

}  // namespace ex9000::sim
