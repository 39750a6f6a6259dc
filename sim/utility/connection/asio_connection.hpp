// A connection through a stream of Boost.Asio.
#pragma once

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/write.hpp>
#include <string>
#include <utility>

#include "firmware/bytes.hpp"
#include "sim/files_and_ports/ports/stop_signals.hpp"
#include "sim/text/fail.hpp"
#include "sim/utility/connection/connection.hpp"

namespace ex9000::utility {

template <class Stream>
class AsioConnection : public Connection {
 public:
  void send(const Data& bytes) override {
    boost::system::error_code error;
    boost::asio::write(stream_, boost::asio::buffer(bytes), error);
    fail_on(error);
  }

  Data receive(Time patience) override {
    const auto end = std::chrono::steady_clock::now() + patience;
    io_.restart();
    while (received_.empty() && !error_ && !interrupted_ && io_.run_one_until(end) != 0) {
    }
    if (std::exchange(interrupted_, false)) {
      wait_for_signal();
      throw Interrupted();
    }
    if (received_.empty()) {
      fail_on(error_);
    }
    return std::exchange(received_, {});
  }

  Time now() override { return std::chrono::steady_clock::now().time_since_epoch(); }
  boost::asio::io_context* io() override { return &io_; }

 protected:
  /// `name`: for messages. The subclass opens the stream, then calls `read`.
  explicit AsioConnection(std::string name) : name_(std::move(name)) {
    sim::add_stop_signals(signals_);
    wait_for_signal();
  }

  Stream& stream() { return stream_; }

  void read() {
    stream_.async_read_some(boost::asio::buffer(buffer_),
                            [this](const boost::system::error_code& error, std::size_t size) {
                              take({buffer_.data(), size}, received_);
                              error_ = error;
                              if (!error) {
                                read();
                              }
                            });
  }

  /// Appends to `received` what the bytes from the stream stand for.
  virtual void take(Bytes bytes, Data& received) {
    received.insert(received.end(), bytes.begin(), bytes.end());
  }

  void fail_on(const boost::system::error_code& error) const {
    if (error == boost::asio::error::eof) {
      sim::unavailable(name_ + ": the other side has closed the connection; start it again");
    }
    if (error) {
      sim::unavailable(name_ + ": " + error.message() + "; connect it again");
    }
  }

 private:
  /// The next one interrupts what a command does to end well.
  void wait_for_signal() {
    signals_.async_wait(
        [this](const boost::system::error_code& error, int /*signal*/) { interrupted_ = !error; });
  }

  std::string name_;
  boost::asio::io_context io_;
  boost::asio::signal_set signals_{io_};
  Stream stream_{io_};
  std::array<std::uint8_t, 4096> buffer_{};
  Data received_;
  boost::system::error_code error_;
  bool interrupted_ = false;
};

}  // namespace ex9000::utility
