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

/// A client that has disappeared without a word frees its place: after 30 s without a byte, the kernel probes
/// it every 10 s, three times. Its default is two hours.
inline void keep_alive(boost::asio::ip::tcp::socket& socket) {
  const auto set = [&socket](int level, int name, int value) {
    setsockopt(socket.native_handle(), level, name, &value, sizeof value);
  };
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 30);
  set(IPPROTO_TCP, TCP_KEEPINTVL, 10);
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
}

/// Accepts the clients of a server; never blocks. The io_context must not accept after the destructor.
template <class Protocol>
class Listener {
 public:
  using Socket = typename Protocol::socket;
  using Endpoint = typename Protocol::endpoint;
  /// The socket does not block. Over TCP, it sends without delay (TCP_NODELAY); see also `keep_alive`.
  using Admit = std::function<void(Socket socket)>;

  explicit Listener(boost::asio::io_context& io) : acceptor_(io), next_try_(io) {}

  /// An error has changed nothing.
  [[nodiscard]] boost::system::error_code listen(const Endpoint& endpoint) {
    // Connections that an ended process has left must not prevent this one from listening.
    constexpr bool kReuseAddress = true;
    try {
      acceptor_ = Acceptor(acceptor_.get_executor(), endpoint, kReuseAddress);
      return {};
    } catch (const boost::system::system_error& error) {
      return error.code();
    }
  }
  [[nodiscard]] Endpoint endpoint() const { return acceptor_.local_endpoint(); }

  /// While the io_context runs. Once.
  void start(Admit admit) {
    admit_ = std::move(admit);
    accept();
  }
  /// Admits all clients that wait, now, without the io_context. Only after `start`.
  void accept_waiting() {
    boost::system::error_code error;
    acceptor_.non_blocking(true, error);
    for (Socket socket = acceptor_.accept(error); !error; socket = acceptor_.accept(error)) {
      prepare_and_admit(std::move(socket));
    }
  }

 private:
  using Acceptor = typename Protocol::acceptor;

  /// 100 ms after an error: without a free file descriptor, immediate retries would take all processor time.
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

/// Owned by their pending operations: a client ends with its last operation.
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

/// With advice, which is `mend`, unless the port is in use or no file descriptor is free.
inline std::string why_not_listening(const boost::system::error_code& error, const std::string& mend) {
  if (error == boost::system::errc::address_in_use) {
    return "the port is in use; name another port, or end the program that uses it";
  }
  const bool no_files = error == boost::system::errc::too_many_files_open ||
                        error == boost::system::errc::too_many_files_open_in_system;
  return error.message() + "; " + (no_files ? "raise the limit with 'ulimit -n', or use fewer lines" : mend);
}

}  // namespace ex9000::sim
