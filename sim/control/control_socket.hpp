// The control commands on a UNIX socket.
#pragma once

#include <sys/types.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/control/control.hpp"
#include "sim/ports/claim.hpp"

namespace ex9000::sim {

/// Any number of clients; a line is a command, each gets one line back, in order. Nothing blocks: a client
/// that does not read its replies is not read from.
class ControlSocket {
 public:
  using Answer = std::function<void(const Control::Reply&)>;
  /// Calls `answer` once, at once or later. Until then nothing more is read from that client.
  using CarryOut = std::function<void(const std::string& command, const Answer& answer)>;

  /// Listens at `path` from now on; what a dead process has left there is taken over. Throws
  /// std::invalid_argument, one line, where the path is in use or cannot be made. What `quit` answers is sent
  /// before `quit` is called.
  ControlSocket(boost::asio::io_context& io, std::string path, CarryOut carry_out,
                std::function<void()> quit);
  /// Removes the socket, if it is still this one's.
  ~ControlSocket();
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;

  /// Once the line is ready for commands.
  void start() { accept(); }

 private:
  struct Client;

  void remove() const;
  void accept();
  void accept_later();
  void read(const std::shared_ptr<Client>& client);
  /// What happens when the answer is on its way.
  enum class Then { ReadOn, Part, Quit };
  void send(const std::shared_ptr<Client>& client, const std::string& text, Then then);

  std::string path_;
  Claim claim_;
  CarryOut carry_out_;
  std::function<void()> quit_;
  boost::asio::local::stream_protocol::acceptor acceptor_;
  boost::asio::steady_timer next_try_;
  std::vector<std::weak_ptr<Client>> clients_;
  dev_t device_ = 0;  ///< of the socket's file, with
  ino_t inode_ = 0;   ///< this number
};

}  // namespace ex9000::sim
