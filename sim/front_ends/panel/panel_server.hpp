// Serves the panel's page and its messages over HTTP and WebSocket, only to this machine.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace boost::asio {
class io_context;
}

namespace ex9000::sim {

class Panel;

/// The page, its files, /models.json, and a WebSocket at /live. A page that reads slowly gets fewer messages,
/// each with the last captured state: they do not accumulate, and the simulation does not wait.
///
/// Rejects requests for another host (is_loopback_host), those that a browser marks as of a page of another
/// origin, and those for /live without Origin.
class PanelServer {
 public:
  /// `port`: nullopt is 9042, or any free port if 9042 is not available; 0 is any free port.
  /// std::runtime_error: no port to listen on. `models`: the content of /models.json. `io` and `panel` must
  /// outlive this object, and `io` must not run after it.
  PanelServer(boost::asio::io_context& io, std::optional<std::uint16_t> port, std::string models,
              Panel& panel);
  ~PanelServer();
  PanelServer(const PanelServer&) = delete;
  PanelServer& operator=(const PanelServer&) = delete;

  /// For example `http://127.0.0.1:9042/`.
  [[nodiscard]] std::string address() const;
  /// As soon as `io` runs.
  void start();

 private:
  class Connections;

  std::unique_ptr<Connections> connections_;
};

}  // namespace ex9000::sim
