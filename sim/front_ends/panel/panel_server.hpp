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

/// Serves one page, its files, the file /models.json, and a WebSocket at /live. A page that reads slowly gets
/// fewer messages, each with the last captured state: messages do not accumulate, and the simulation does not
/// wait for the page.
///
/// Rejects requests for another host or port (see is_loopback_host), requests that a browser marks as
/// requests of a page of another origin, and requests for /live that have no header Origin.
class PanelServer {
 public:
  /// Listens on `port`. If `port` is nullopt, listens on 9042, or on any free port if 9042 is not available.
  /// If `port` is 0, listens on any free port. Throws std::runtime_error with a one-line message if
  /// listening fails. `models` is the content of /models.json. `io` and `panel` must outlive this object, and
  /// `io` must not run after it.
  PanelServer(boost::asio::io_context& io, std::optional<std::uint16_t> port, std::string models,
              Panel& panel);
  ~PanelServer();
  PanelServer(const PanelServer&) = delete;
  PanelServer& operator=(const PanelServer&) = delete;

  /// Returns the URL, for example `http://127.0.0.1:9042/`.
  [[nodiscard]] std::string address() const;
  /// Accepts connections as soon as `io` runs.
  void start();

 private:
  class Connections;

  std::unique_ptr<Connections> connections_;
};

}  // namespace ex9000::sim
