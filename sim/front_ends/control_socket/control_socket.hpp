// The control commands on a UNIX socket.
#pragma once

#include <sys/types.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <functional>
#include <memory>
#include <string>

#include "sim/files_and_ports/ports/claim.hpp"
#include "sim/files_and_ports/ports/listening.hpp"
#include "sim/front_ends/control_socket/control.hpp"

namespace ex9000::sim {

/// Serves up to 64 clients, and disconnects any more. Each line from a client is a command, and gets one line
/// as reply, in order. While a client does not read its replies, only this client is not served.
class ControlSocket {
 public:
  using Answer = std::function<void(const Control::Reply&)>;
  /// Calls `answer` exactly once, now or later, unless the program ends first. Until then, nothing more is
  /// read from the client that sent the command.
  using CarryOut = std::function<void(const std::string& command, const Answer& answer)>;

  /// Replaces a socket of a process that has ended. std::runtime_error: another program listens there. `quit`
  /// is called when a reply with Reply::quit has been sent, or sending it has failed.
  ControlSocket(boost::asio::io_context& io, std::string path, CarryOut carry_out,
                std::function<void()> quit);
  /// Removes the socket file if it is still this object's.
  ~ControlSocket();
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;

  /// When the lines are ready for commands.
  void start();

 private:
  struct Client;

  void admit(boost::asio::local::stream_protocol::socket socket);
  void read(const std::shared_ptr<Client>& client);
  /// After the reply.
  enum class Then { ReadOn, Part, Quit };
  void send(const std::shared_ptr<Client>& client, const std::string& text, Then then);

  std::string path_;
  Claim claim_;
  CarryOut carry_out_;
  std::function<void()> quit_;
  Listener<boost::asio::local::stream_protocol> listener_;
  Clients<Client> clients_;
  dev_t device_ = 0;  ///< device of the socket file
  ino_t inode_ = 0;   ///< inode of the socket file
};

}  // namespace ex9000::sim
