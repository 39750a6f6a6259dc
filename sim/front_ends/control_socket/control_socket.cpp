#include "sim/front_ends/control_socket/control_socket.hpp"

#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <utility>

#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

using Local = boost::asio::local::stream_protocol;

constexpr std::size_t kLongestLine = 1000;  // characters, without the newline
constexpr std::size_t kMostClients = 64;    // at the same time

/// Removes the socket of a process that has ended. Throws if it may be in use, or is not a socket.
void remove_stale(boost::asio::io_context& io, const std::string& path, const Claim& claim) {
  const std::string in_use = path + ": another program listens there; end it or name another path";
  if (!claim.held()) {
    unavailable(in_use);
  }
  struct stat status {};
  if (lstat(path.c_str(), &status) != 0) {
    return;
  }
  if (!S_ISSOCK(status.st_mode)) {
    fail(path + ": the path is in use by a file that is not a socket; remove it or name another path");
  }
  Local::socket visitor(io);
  boost::system::error_code error;
  visitor.open(Local(), error);
  if (!error) {
    visitor.non_blocking(true, error);  // otherwise connect could wait for a program that accepts nothing
  }
  if (!error) {
    visitor.connect(Local::endpoint(path), error);
  }
  if (error != boost::asio::error::connection_refused) {
    const bool listens = !error || error == boost::asio::error::no_buffer_space;  // Asio's code for EAGAIN
    if (listens) {
      unavailable(in_use);
    }
    fail(path + ": " + error.message() + "; name another path");
  }
  unlink(path.c_str());
}

}  // namespace

struct ControlSocket::Client {
  Local::socket socket;
  std::string input;
  std::string output;
};

ControlSocket::ControlSocket(boost::asio::io_context& io, std::string path, CarryOut carry_out,
                             std::function<void()> quit)
    : path_(std::move(path)),
      claim_(path_),
      carry_out_(std::move(carry_out)),
      quit_(std::move(quit)),
      listener_(io) {
  if (path_.empty() || path_.size() >= sizeof(sockaddr_un::sun_path)) {
    fail(path_ + ": expected a path of 1 to " + std::to_string(sizeof(sockaddr_un::sun_path) - 1) +
         " characters");
  }
  remove_stale(io, path_, claim_);
  if (const auto error = listener_.listen(Local::endpoint(path_))) {
    fail(path_ + ": " + error.message() + "; name a path that can be written");
  }
  struct stat status {};
  if (lstat(path_.c_str(), &status) == 0) {
    device_ = status.st_dev;
    inode_ = status.st_ino;
  }
}

ControlSocket::~ControlSocket() {
  struct stat status {};
  if (lstat(path_.c_str(), &status) == 0 && status.st_dev == device_ && status.st_ino == inode_) {
    unlink(path_.c_str());
  }
}

void ControlSocket::start() {
  listener_.start([this](Local::socket socket) { admit(std::move(socket)); });
}

void ControlSocket::admit(Local::socket socket) {
  const auto client = std::make_shared<Client>(Client{std::move(socket), "", ""});
  if (clients_.all().size() < kMostClients) {
    clients_.add(client);
    read(client);
  } else {
    send(client, "error: there are " + std::to_string(kMostClients) + " clients already; close one of them",
         Then::Part);
  }
}

void ControlSocket::read(const std::shared_ptr<Client>& client) {
  boost::asio::async_read_until(
      client->socket, boost::asio::dynamic_buffer(client->input, kLongestLine + 1), '\n',
      [this, client](const boost::system::error_code& error, std::size_t size) {
        if (error == boost::asio::error::not_found) {
          send(client,
               "error: the command is too long; expected up to " + std::to_string(kLongestLine) +
                   " characters",
               Then::Part);
        } else if (error == boost::asio::error::eof && !client->input.empty()) {
          send(client, "error: the last command was ignored; expected a newline after it", Then::Part);
        } else if (!error) {
          const std::string line = client->input.substr(0, size - 1);
          client->input.erase(0, size);
          carry_out_(line, [this, client](const Control::Reply& reply) {
            send(client, reply.text, reply.quit ? Then::Quit : Then::ReadOn);
          });
        }
      });
}

void ControlSocket::send(const std::shared_ptr<Client>& client, const std::string& text, Then then) {
  client->output = text + "\n";
  boost::asio::async_write(
      client->socket, boost::asio::buffer(client->output),
      [this, client, then](const boost::system::error_code& /*error*/, std::size_t /*size*/) {
        if (then == Then::Quit) {
          quit_();
        } else if (then == Then::ReadOn) {
          read(client);  // even after the client has disconnected, because its last commands may be unread
        }
      });
}

}  // namespace ex9000::sim
