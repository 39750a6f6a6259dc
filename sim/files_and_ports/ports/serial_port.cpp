#include "sim/files_and_ports/ports/serial_port.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include "sim/files_and_ports/ports/serial_device.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/system_error.hpp"

namespace ex9000::sim {

namespace {

/// A reply is held back this long, or until it is complete: delays of the host must not cause gaps in it.
constexpr std::chrono::milliseconds kCushion{10};

/// The caller must close it.
int open_port(const std::string& device, hal::SerialMode mode) {
  FileDescriptor port = open_serial_device(device);
  if (ioctl(port.get(), TIOCEXCL) != 0) {
    unavailable(reason() + "; name another port");
  }
  set_serial_mode(port.get(), mode);
  return port.release();
}

}  // namespace

SerialPort::SerialPort(boost::asio::io_context& io, const std::string& place, const std::string& device,
                       hal::SerialMode mode, bool echo)
    : device_(device),
      where_(place + device),
      descriptor_(io, with_place(where_ + ": ", [&] { return open_port(device, mode); })) {
  if (echo) {
    echo_.emplace(mode);
  }
  if (has_parity(mode.format)) {
    marks_.emplace();
  }
}

PortSummary SerialPort::summary() const { return {"serial", device_, "serial port " + device_}; }

void SerialPort::start(Arrivals& arrivals) {
  arrivals_ = &arrivals;
  read();
}

void SerialPort::resume() {
  if (paused_) {
    read();
  }
}

void SerialPort::read() {
  paused_ = false;
  descriptor_.async_read_some(
      boost::asio::buffer(buffer_), [this](const boost::system::error_code& error, std::size_t size) {
        if (error == boost::asio::error::operation_aborted) {
          return;
        }
        if (error) {
          throw std::runtime_error(where_ + ": the port has disappeared (" + error.message() +
                                   "); connect it and start the simulator again");
        }
        take(size);
        if (!paused_) {
          read();
        }
      });
}

void SerialPort::take(std::size_t size) {
  Positions damaged;
  std::size_t taken = size;
  if (marks_) {
    taken = 0;
    for (const ParityMarks::Arrived each : marks_->read(buffer_.data(), size)) {
      if (each.damaged) {
        damaged.push_back(taken);
      }
      buffer_[taken++] = each.byte;
    }
  }
  const std::size_t echo = echo_ ? echo_->in({buffer_.data(), taken}, OwnEcho::Clock::now()) : 0;
  damaged.erase(damaged.begin(), std::lower_bound(damaged.begin(), damaged.end(), echo));
  for (std::size_t& position : damaged) {
    position -= echo;
  }
  paused_ = echo < taken && !arrivals_->bytes(*this, {buffer_.data() + echo, taken - echo}, damaged, nullptr);
}

std::size_t SerialPort::send(const std::vector<std::uint8_t>& bytes) {
  if (held_back_.empty()) {
    began_ = OwnEcho::Clock::now();
  }
  held_back_.insert(held_back_.end(), bytes.begin(), bytes.end());
  if (under_way_ || OwnEcho::Clock::now() - began_ >= kCushion) {
    write_out();
    under_way_ = true;
  }
  return std::exchange(dropped_, 0);
}

void SerialPort::sent() {
  write_out();
  under_way_ = false;
}

void SerialPort::write_out() {
  const ssize_t written = write(descriptor_.native_handle(), held_back_.data(), held_back_.size());
  const std::size_t sent = written > 0 ? static_cast<std::size_t>(written) : 0;
  if (echo_) {
    echo_->sent({held_back_.data(), sent}, OwnEcho::Clock::now());
  }
  if (written >= 0 || errno == EAGAIN) {  // after another error, reading fails too
    dropped_ += held_back_.size() - sent;
  }
  held_back_.clear();
}

}  // namespace ex9000::sim
