// Accepts the Modbus TCP clients of one line.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <string>

#include "sim/files_and_ports/ports/tcp_address.hpp"
#include "sim/files_and_ports/ports/tcp_listener.hpp"
#include "sim/front_ends/modbus_tcp/gateway.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Receives requests over Modbus TCP and sends them on the line as Modbus RTU frames, like a serial device
/// server. Each client may send further requests before it has received its replies. A client that sends a
/// frame with a wrong protocol or length is disconnected after the replies to its earlier requests. No
/// function blocks.
class ModbusTcpServer {
 public:
  /// The server calls this function when `size` bytes of a client have arrived, or with a `size` of 0 when a
  /// client accepts replies again. The function must call `process` exactly once, during the call or later.
  /// Before the call of `process`, the line must be advanced to the line's present time (see Pacer::now),
  /// because `process` may send requests. The function returns false if the server must stop reading until
  /// `resume`.
  using Received = std::function<bool(std::size_t size, std::function<void()> process)>;

  /// Receives a one-line message when the server refuses a client, or disconnects it because of its bytes.
  using Notice = std::function<void(const std::string& text)>;

  /// Starts to listen. Throws std::runtime_error with a one-line message if the address is not available.
  /// `line` must outlive this object. `timeout`: see `ask_on_line`.
  ModbusTcpServer(
      boost::asio::io_context& io, Line& line, const TcpAddress& address,
      VirtualTime timeout = kGatewayTimeout, Notice notice = [](const std::string& /*text*/) {});
  ModbusTcpServer(const ModbusTcpServer&) = delete;
  ModbusTcpServer& operator=(const ModbusTcpServer&) = delete;
  ~ModbusTcpServer();

  /// Starts to accept clients. Call this once. The server calls `received` while the io_context runs, and
  /// during `read_waiting`.
  void start(Received received);
  /// Continues to read after `received` has returned false.
  void resume();
  /// Accepts clients that have connected. Then calls `received` during this call for the bytes that have
  /// arrived, until `received` returns false; the io_context need not run. Does not call `received` while the
  /// server waits for `resume`. Call this only after `start`.
  void read_waiting();
  /// Returns the HOST:PORT on which the server listens.
  [[nodiscard]] std::string address() const { return listener_.address(); }

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
  Received received_;
  bool paused_ = false;
  std::list<ClientPointer> clients_;
};

}  // namespace ex9000::sim
