// A connection that shows its frames.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>

#include "sim/line_monitor/frames/frame_meaning.hpp"
#include "sim/utility/connection/connection.hpp"

namespace ex9000::utility {

/// What the port has taken or given at once, or until it was silent.
struct PortFrame {
  bool sent;
  Data bytes;
  Time began;
  Time ended;
  hal::SerialMode mode;
};

class WatchedConnection final : public Connection {
 public:
  using See = std::function<void(const PortFrame& frame)>;

  WatchedConnection(std::unique_ptr<Connection> connection, hal::SerialMode mode, See see)
      : connection_(std::move(connection)), mode_(mode), see_(std::move(see)) {}

  void set_mode(hal::SerialMode mode) override {
    connection_->set_mode(mode);
    mode_ = mode;
  }
  [[nodiscard]] bool has_formats() const override { return connection_->has_formats(); }

  void send(const Data& bytes) override {
    end_frame();
    const Time began = now();
    connection_->send(bytes);
    sent_ = bytes;
    see_({true, bytes, began, began + time_of(bytes.size(), mode_), mode_});
  }

  Data receive(Time patience) override {
    Data bytes = connection_->receive(patience);
    if (bytes.empty()) {
      end_frame();
    } else if (received_.empty()) {
      began_ = now() - time_of(bytes.size(), mode_);
    }
    ended_ = bytes.empty() ? ended_ : now();
    received_.insert(received_.end(), bytes.begin(), bytes.end());
    if (received_.size() > kLongest) {
      end_frame();
    }
    return bytes;
  }

  Time now() override { return connection_->now(); }
  boost::asio::io_context* io() override { return connection_->io(); }

 private:
  static constexpr std::size_t kLongest = 600;  // the longest frame and its echo

  /// Without the echo of what has been sent; of Modbus, what equals it may also be the reply.
  void end_frame() {
    if (received_ == sent_ && sim::looks_like_dcon(sent_)) {
      received_.clear();
    }
    if (received_.size() > sent_.size() && std::equal(sent_.begin(), sent_.end(), received_.begin())) {
      received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(sent_.size()));
      began_ += time_of(sent_.size(), mode_);
    }
    sent_.clear();
    if (!received_.empty()) {
      see_({false, std::exchange(received_, {}), began_, ended_, mode_});
    }
  }

  std::unique_ptr<Connection> connection_;
  hal::SerialMode mode_;
  See see_;
  Data sent_;  ///< last; empty: what has followed it has been seen
  Data received_;
  Time began_{0};
  Time ended_{0};
};

}  // namespace ex9000::utility
