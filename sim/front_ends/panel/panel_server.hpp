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

  /// Carries out a request of the page; a later call of `next` returns the reply. A request may contain a
  /// command and a second command that undoes the first one. If the first command succeeds, the page holds
  /// its action active until the page sends the second command. When this object is destroyed, it carries out
  /// the second command of each active action. Returns false if `text` is not a valid request, or if the page
  /// would hold too many actions active.
  virtual bool ask(const std::string& text) = 0;
  /// Returns the next message for the page: replies, the recent traffic, and the changes that `look` has
  /// captured, each if the page has not received it yet. Returns an empty text if there is nothing to send.
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
/// fewer messages, each with the last captured state: messages do not accumulate, and the simulation does not
/// wait for the page.
///
/// Rejects requests for a host name other than 127.0.0.1 and localhost, requests that a browser marks as
/// requests of a page of another origin, and requests for a WebSocket without an Origin.
class PanelServer {
 public:
  /// Listens on `port`. If `port` is nullopt, listens on 9042, or on any free port if 9042 is not available.
  /// If `port` is 0, listens on any free port. Throws std::invalid_argument with a one-line message if
  /// listening fails. `models` is the content of /models.json. `io` and `source` must outlive this object.
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
