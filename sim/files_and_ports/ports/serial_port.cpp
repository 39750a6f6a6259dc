#include "sim/files_and_ports/ports/serial_port.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include "sim/files_and_ports/files/file_descriptor.hpp"
#include "sim/files_and_ports/ports/termios_format.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/system_error.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

/// A reply is held back this long, or until it is complete: delays of the host must not cause gaps in it.
constexpr std::chrono::milliseconds kCushion{10};

/// Else an adapter may hold bytes back for up to 16 ms, and split frames. Not all drivers support it.
void ask_for_low_latency(int fd) {
  serial_struct settings{};
  if (ioctl(fd, TIOCGSERIAL, &settings) == 0) {
    settings.flags |= ASYNC_LOW_LATENCY;
    ioctl(fd, TIOCSSERIAL, &settings);
  }
}

constexpr const char* kInUse = "is in use by another program; end that program or name another port";

void set_up(int fd, hal::SerialMode mode) {
  termios before{};
  if (tcgetattr(fd, &before) != 0) {
    fail("is not a serial port; name one, for example /dev/ttyUSB0");
  }
  if (flock(fd, LOCK_EX | LOCK_NB) != 0 || ioctl(fd, TIOCEXCL) != 0) {
    unavailable(kInUse);
  }
  termios settings = before;
  cfmakeraw(&settings);
  // No XON/XOFF: the port could send XOFF. With parity, the kernel marks line errors (see ParityMarks).
  settings.c_iflag = has_parity(mode.format) ? INPCK | PARMRK : 0;
  settings.c_cflag &= ~static_cast<tcflag_t>(kTermiosFormat | CRTSCTS);
  settings.c_cflag |= CLOCAL | CREAD | termios_format(mode.format);
  termios taken{};  // tcsetattr succeeds even if it applies only a part of the settings
  if (cfsetspeed(&settings, mode.baud) != 0 || tcsetattr(fd, TCSANOW, &settings) != 0 ||
      tcgetattr(fd, &taken) != 0 || cfgetospeed(&taken) != cfgetospeed(&settings) ||
      ((taken.c_cflag ^ settings.c_cflag) & kTermiosFormat) != 0) {
    tcsetattr(fd, TCSANOW, &before);
    fail("cannot be set to " + mode_text(mode.baud, mode.format) +
         "; choose another rate or format for the line");
  }
  ask_for_low_latency(fd);
  tcflush(fd, TCIOFLUSH);
}

/// The caller must close it.
int open_port(const std::string& device, hal::SerialMode mode) {
  FileDescriptor port(open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port.is_open()) {
    unavailable(errno == EBUSY ? kInUse : reason() + "; name a serial port that can be read and written");
  }
  set_up(port.get(), mode);
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
