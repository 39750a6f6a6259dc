#include "sim/utility/connection/port.hpp"

#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <optional>

#include "sim/files_and_ports/ports/parity_marks.hpp"
#include "sim/files_and_ports/ports/serial_device.hpp"
#include "sim/text/values.hpp"
#include "sim/utility/connection/asio_connection.hpp"

namespace ex9000::utility {

namespace {

using boost::asio::ip::tcp;

/// A pseudo-terminal carries bytes, without parity and stop bits.
bool is_pseudo_terminal(int fd) {
  constexpr unsigned kFirst = 136;  // Linux, Documentation/admin-guide/devices.txt: UNIX98 PTY slaves
  constexpr unsigned kLast = 143;
  struct stat status {};
  return fstat(fd, &status) == 0 && major(status.st_rdev) >= kFirst && major(status.st_rdev) <= kLast;
}

class SerialConnection final : public AsioConnection<boost::asio::posix::stream_descriptor> {
 public:
  SerialConnection(const std::string& device, hal::SerialMode mode)
      : AsioConnection(device), place_(device + ": ") {
    sim::FileDescriptor port = sim::with_place(place_, [&] { return sim::open_serial_device(device); });
    has_formats_ = !is_pseudo_terminal(port.get());
    stream().assign(port.release());
    set_mode(mode);
    read();
  }

  void set_mode(hal::SerialMode mode) override {
    const hal::SerialMode taken{mode.baud, has_formats_ ? mode.format : LineFormat::k8N1};
    sim::with_place(place_, [&] { sim::set_serial_mode(stream().native_handle(), taken); });
    marks_.reset();
    if (has_parity(taken.format)) {
      marks_.emplace();
    }
  }

  [[nodiscard]] bool has_formats() const override { return has_formats_; }

 private:
  void take(Bytes bytes, Data& received) override {
    if (!marks_) {
      AsioConnection::take(bytes, received);
      return;
    }
    for (const sim::ParityMarks::Arrived arrived : marks_->read(bytes.data, bytes.size)) {
      received.push_back(arrived.byte);
    }
  }

  std::string place_;
  bool has_formats_ = true;
  std::optional<sim::ParityMarks> marks_;
};

class TcpConnection final : public AsioConnection<tcp::socket> {
 public:
  explicit TcpConnection(const Port& port) : AsioConnection(port.name) {
    boost::system::error_code error;
    tcp::resolver resolver(*io());
    const auto places = resolver.resolve(port.host, port.number, error);
    if (!error) {
      boost::asio::connect(stream(), places, error);
    }
    if (error == boost::asio::error::interrupted) {
      throw Interrupted();
    }
    if (error) {
      sim::unavailable(port.name + ": " + error.message() +
                       "; name a host and a port that accept connections");
    }
    stream().set_option(tcp::no_delay(true));
    read();
  }

  void set_mode(hal::SerialMode /*mode*/) override {}
};

}  // namespace

Port parse_port(const std::string& text) {
  constexpr const char* kModbusTcpPort = "502";
  constexpr unsigned kLargestPort = 65535;
  const std::string kind = text.substr(0, text.find(':'));
  const bool gateway = kind == "modbus-tcp";
  if (text.empty() || (!gateway && kind != "tcp") || kind.size() == text.size()) {
    return {Port::Kind::Serial, text, "", ""};
  }
  Port port{gateway ? Port::Kind::ModbusTcp : Port::Kind::Tcp, text, text.substr(kind.size() + 1),
            kModbusTcpPort};
  const std::size_t bracket = port.host.rfind(']');
  const std::size_t colon = port.host.rfind(':');
  const bool has_number = colon != std::string::npos && (bracket == std::string::npos || colon > bracket);
  if (has_number) {
    port.number = port.host.substr(colon + 1);
    port.host.resize(colon);
  }
  if (port.host.size() > 1 && port.host.front() == '[' && port.host.back() == ']') {
    port.host = port.host.substr(1, port.host.size() - 2);
  }
  if (port.host.empty() || (!gateway && !has_number) || !sim::whole_number(port.number, kLargestPort)) {
    sim::fail("'" + text + "': expected tcp:HOST:PORT or modbus-tcp:HOST[:PORT]");
  }
  return port;
}

std::unique_ptr<Connection> open(const Port& port, hal::SerialMode mode) {
  if (port.kind == Port::Kind::Serial) {
    return std::make_unique<SerialConnection>(port.name, mode);
  }
  return std::make_unique<TcpConnection>(port);
}

}  // namespace ex9000::utility
