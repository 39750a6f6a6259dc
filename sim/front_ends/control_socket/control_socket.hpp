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

/// Serves up to 64 clients at the same time, and disconnects further clients. Each line from a client is a
/// command. The reply to each command is one line, and replies keep the order of the commands. If a client
/// does not read its replies, the server stops reading from this client and continues to serve the others.
class ControlSocket {
 public:
  using Answer = std::function<void(const Control::Reply&)>;
  /// Carries out `command`. Calls `answer` exactly once, during the call or later, unless the program ends
  /// first. Until `answer` is called, the server reads nothing more from the client that sent the command.
  using CarryOut = std::function<void(const std::string& command, const Answer& answer)>;

  /// Starts to listen on `path`; replaces a socket of a process that has ended. Throws std::invalid_argument
  /// with a one-line message if the path is empty or too long, if a file that is not a socket is there, or if
  /// it cannot be created, and std::runtime_error if another program listens there. If the member `quit` of a
  /// reply is true, the parameter `quit` is called after the reply has been sent, or after an attempt to send
  /// the reply has failed.
  ControlSocket(boost::asio::io_context& io, std::string path, CarryOut carry_out,
                std::function<void()> quit);
  /// Removes the socket file if it still belongs to this object.
  ~ControlSocket();
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;

  /// Starts to accept clients. Does not block. Call this function when the lines are ready for commands.
  void start();

 private:
  struct Client;

  void admit(boost::asio::local::stream_protocol::socket socket);
  void read(const std::shared_ptr<Client>& client);
  /// The action after the reply has been sent.
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
