// Serves the panel's page, and talks to it, over HTTP and WebSocket on this machine alone.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace boost::asio {
class io_context;
}

namespace ex9000::sim {

/// The one behind an open page.
class PanelViewer {
 public:
  PanelViewer() = default;
  PanelViewer(const PanelViewer&) = delete;
  PanelViewer& operator=(const PanelViewer&) = delete;
  virtual ~PanelViewer() = default;

  /// Takes what the page asks for; the answer is part of what is told next. False: that is no request.
  /// What it holds down meanwhile is let go when this goes.
  virtual bool ask(const std::string& text) = 0;
  /// What it has not been told yet, as of the last look; empty: nothing.
  virtual std::string next() = 0;
};

/// Where pages get from what they show.
class PanelSource {
 public:
  PanelSource() = default;
  PanelSource(const PanelSource&) = delete;
  PanelSource& operator=(const PanelSource&) = delete;
  virtual ~PanelSource() = default;

  /// Takes note of how things are, for all viewers.
  virtual void look() = 0;
  virtual std::unique_ptr<PanelViewer> viewer() = 0;
};

/// One page, its files, and a WebSocket at /live. A page that reads slowly is told less often, and always how
/// things are by then: nothing queues up, and nobody waits for it.
///
/// Who asks under another name than the loopback's is refused, and so is a WebSocket that another site's page
/// has opened.
class PanelServer {
 public:
  /// Listens. Nothing: on 9042, or on any free port where that is taken; 0: any. Throws
  /// std::invalid_argument, one line, where a port that was named cannot be had. Both live as long as this.
  PanelServer(boost::asio::io_context& io, std::optional<std::uint16_t> port, PanelSource& source);
  ~PanelServer();
  PanelServer(const PanelServer&) = delete;
  PanelServer& operator=(const PanelServer&) = delete;

  /// `http://127.0.0.1:9042/`.
  [[nodiscard]] std::string address() const;
  /// Lets people in as soon as `io` runs.
  void start();

 private:
  class Listener;

  std::shared_ptr<Listener> listener_;
};

}  // namespace ex9000::sim
