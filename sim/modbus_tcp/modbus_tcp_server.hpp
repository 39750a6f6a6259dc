// The clients of Modbus TCP on one line.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <string>

#include "sim/line/line.hpp"
#include "sim/modbus_tcp/gateway.hpp"
#include "sim/ports/tcp_address.hpp"
#include "sim/ports/tcp_listener.hpp"

namespace ex9000::sim {

/// A gateway like a serial device server: Modbus TCP in, Modbus RTU on the line. Each client may send further
/// requests before it has received its replies. A client that sends a frame with a wrong protocol or length
/// is disconnected after the replies to its earlier requests. No function blocks.
class ModbusTcpServer {
 public:
  /// Accepts `size` bytes of a client that have arrived. `process` acts on the line: it must be called once,
  /// at the line's present time, now or later. Returns false if the server must read no more until `resume`.
  using Received = std::function<bool(std::size_t size, std::function<void()> process)>;

  /// Starts to listen. Throws std::invalid_argument with a one-line message if the address is not available.
  /// `line` must outlive this object.
  ModbusTcpServer(boost::asio::io_context& io, Line& line, const TcpAddress& address);
  ModbusTcpServer(const ModbusTcpServer&) = delete;
  ModbusTcpServer& operator=(const ModbusTcpServer&) = delete;
  ~ModbusTcpServer();

  /// Accepts clients. Call this once. `received` is called while the io_context runs.
  void start(Received received);
  /// Continues to read after `received` has returned false.
  void resume();
  /// Calls `received` at once for all bytes that have arrived; the io_context need not run. Call this only if
  /// `received` can take more bytes.
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
  Gateway gateway_;
  TcpListener listener_;
  Received received_;
  bool paused_ = false;
  std::list<ClientPointer> clients_;
};

}  // namespace ex9000::sim
