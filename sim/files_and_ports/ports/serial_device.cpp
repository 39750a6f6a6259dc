#include "sim/files_and_ports/ports/serial_device.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <cerrno>

#include "sim/files_and_ports/ports/termios_format.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/system_error.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

constexpr const char* kInUse = "is in use by another program; end that program or name another port";

/// Else an adapter may hold bytes back for up to 16 ms, and split frames. Not all drivers support it.
void ask_for_low_latency(int fd) {
  serial_struct settings{};
  if (ioctl(fd, TIOCGSERIAL, &settings) == 0) {
    settings.flags |= ASYNC_LOW_LATENCY;
    ioctl(fd, TIOCSSERIAL, &settings);
  }
}

}  // namespace

FileDescriptor open_serial_device(const std::string& device) {
  FileDescriptor port(open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port.is_open()) {
    unavailable(errno == EBUSY ? kInUse : reason() + "; name a serial port that can be read and written");
  }
  termios settings{};
  if (tcgetattr(port.get(), &settings) != 0) {
    fail("is not a serial port; name one, for example /dev/ttyUSB0");
  }
  if (flock(port.get(), LOCK_EX | LOCK_NB) != 0) {
    unavailable(kInUse);
  }
  ask_for_low_latency(port.get());
  return port;
}

void set_serial_mode(int fd, hal::SerialMode mode) {
  termios before{};
  tcgetattr(fd, &before);
  termios settings = before;
  cfmakeraw(&settings);
  // No XON/XOFF: the port could send XOFF.
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
  tcflush(fd, TCIOFLUSH);
}

}  // namespace ex9000::sim
