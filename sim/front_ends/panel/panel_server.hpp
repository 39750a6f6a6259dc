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

/// The server's side of one open page.
class PanelViewer {
 public:
  PanelViewer() = default;
  PanelViewer(const PanelViewer&) = delete;
  PanelViewer& operator=(const PanelViewer&) = delete;
  virtual ~PanelViewer() = default;

  /// Carries out a request of the page; a later call of `next` returns the reply. Returns false if `text` is
  /// not a valid request, or if the page holds too many actions active. Actions that the page holds active
  /// are undone when this object is destroyed.
  virtual bool ask(const std::string& text) = 0;
  /// Returns the next message for the page: the reply to its request, and those changes before the last look
  /// that the page has not received yet. Returns an empty text if there is nothing to send.
  virtual std::string next() = 0;
};

/// The source of the data that pages show.
class PanelSource {
 public:
  PanelSource() = default;
  PanelSource(const PanelSource&) = delete;
  PanelSource& operator=(const PanelSource&) = delete;
  virtual ~PanelSource() = default;

  /// Captures the present state for all viewers.
  virtual void look() = 0;
  /// Returns the viewer for a page that has connected.
  virtual std::unique_ptr<PanelViewer> viewer() = 0;
};

/// Serves one page, its files, the file /models.json, and a WebSocket at /live. A page that reads slowly gets
/// fewer messages, each with the state at that time: messages do not accumulate, and the simulation does not
/// wait for the page.
///
/// Rejects requests for a host name other than 127.0.0.1 and localhost, and requests from pages of other
/// sites.
class PanelServer {
 public:
  /// Listens on `port`. If `port` is nullopt, listens on 9042, or on any free port if 9042 is in use. If
  /// `port` is 0, listens on any free port. Throws std::invalid_argument with a one-line message if a given
  /// port is not available. `models` is the content of /models.json. `io` and `source` must outlive this
  /// object.
  PanelServer(boost::asio::io_context& io, std::optional<std::uint16_t> port, std::string models,
              PanelSource& source);
  ~PanelServer();
  PanelServer(const PanelServer&) = delete;
  PanelServer& operator=(const PanelServer&) = delete;

  /// Returns the URL, for example `http://127.0.0.1:9042/`.
  [[nodiscard]] std::string address() const;
  /// Accepts connections as soon as `io` runs.
  void start();

 private:
  class Listener;

  std::shared_ptr<Listener> listener_;
};

}  // namespace ex9000::sim
