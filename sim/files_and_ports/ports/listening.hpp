// How the clients of a server come and are listed.
#pragma once

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace ex9000::sim {

/// Makes the kernel probe the client, so that a client that has disappeared without a word frees its place:
/// after 30 s without a byte, every 10 s, until three probes have no answer. By default the kernel waits two
/// hours.
inline void keep_alive(boost::asio::ip::tcp::socket& socket) {
  const auto set = [&socket](int level, int name, int value) {
    setsockopt(socket.native_handle(), level, name, &value, sizeof value);
  };
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 30);
  set(IPPROTO_TCP, TCP_KEEPINTVL, 10);
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
}

/// Accepts the clients of a server. None of the functions blocks. After the destructor, the io_context must
/// not accept any more.
template <class Protocol>
class Listener {
 public:
  using Socket = typename Protocol::socket;
  using Endpoint = typename Protocol::endpoint;
  /// Receives the socket of each client. It does not block; over TCP, it sends without delay (TCP_NODELAY),
  /// see also `keep_alive`.
  using Admit = std::function<void(Socket socket)>;

  explicit Listener(boost::asio::io_context& io) : acceptor_(io), next_try_(io) {}

  /// Begins to listen. If that fails, returns the error and changes nothing.
  [[nodiscard]] boost::system::error_code listen(const Endpoint& endpoint) {
    // Connections of a process that has ended may still exist. They must not prevent this process from
    // listening.
    constexpr bool kReuseAddress = true;
    try {
      acceptor_ = Acceptor(acceptor_.get_executor(), endpoint, kReuseAddress);
      return {};
    } catch (const boost::system::system_error& error) {
      return error.code();
    }
  }
  [[nodiscard]] Endpoint endpoint() const { return acceptor_.local_endpoint(); }

  /// Calls `admit` for each client while the io_context runs. Call this once.
  void start(Admit admit) {
    admit_ = std::move(admit);
    accept();
  }
  /// Before this function returns, it calls `admit` for all clients that wait to be accepted. The io_context
  /// does not have to run. Call this only after `start`.
  void accept_waiting() {
    boost::system::error_code error;
    acceptor_.non_blocking(true, error);
    for (Socket socket = acceptor_.accept(error); !error; socket = acceptor_.accept(error)) {
      prepare_and_admit(std::move(socket));
    }
  }

 private:
  using Acceptor = typename Protocol::acceptor;

  /// After an error, accepts again after 100 ms: if the process has no free file descriptor, immediate
  /// retries would use all of the processor's time.
  void accept() {
    acceptor_.async_accept([this](const boost::system::error_code& error, Socket socket) {
      if (!error) {
        prepare_and_admit(std::move(socket));
        accept();
      } else if (error != boost::asio::error::operation_aborted) {
        next_try_.expires_after(std::chrono::milliseconds(100));
        next_try_.async_wait([this](const boost::system::error_code& aborted) {
          if (!aborted) {
            accept();
          }
        });
      }
    });
  }

  void prepare_and_admit(Socket socket) {
    boost::system::error_code ignored;
    socket.non_blocking(true, ignored);
    if constexpr (std::is_same_v<Protocol, boost::asio::ip::tcp>) {
      socket.set_option(boost::asio::ip::tcp::no_delay(true), ignored);
      keep_alive(socket);
    }
    admit_(std::move(socket));
  }

  Acceptor acceptor_;
  boost::asio::steady_timer next_try_;
  Admit admit_;
};

/// The clients of a server that their pending operations own: a client ends with its last operation.
template <class Client>
class Clients {
 public:
  void add(const std::shared_ptr<Client>& client) { clients_.push_back(client); }
  [[nodiscard]] std::vector<std::shared_ptr<Client>> all() {
    std::vector<std::shared_ptr<Client>> all;
    for (const std::weak_ptr<Client>& each : clients_) {
      if (auto client = each.lock()) {
        all.push_back(std::move(client));
      }
    }
    clients_.assign(all.begin(), all.end());
    return all;
  }

 private:
  std::vector<std::weak_ptr<Client>> clients_;
};

/// Returns a text for the error, with advice for the user. The advice is `mend`, unless the port is in use,
/// or the process or the system has no free file descriptor.
inline std::string why_not_listening(const boost::system::error_code& error, const std::string& mend) {
  if (error == boost::system::errc::address_in_use) {
    return "the port is in use; name another port, or end the program that uses it";
  }
  const bool no_files = error == boost::system::errc::too_many_files_open ||
                        error == boost::system::errc::too_many_files_open_in_system;
  return error.message() + "; " + (no_files ? "raise the limit with 'ulimit -n', or use fewer lines" : mend);
}

}  // namespace ex9000::sim
