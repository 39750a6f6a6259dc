#include "sim/files_and_ports/ports/tcp_address.hpp"

#include <boost/asio/ip/address.hpp>
#include <limits>

#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

constexpr const char* kLoopback = "127.0.0.1";

}  // namespace

TcpAddress parse_tcp_address(const std::string& text) {
  const auto colon = text.rfind(':');
  std::string host = colon == std::string::npos ? "" : text.substr(0, colon);
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  const auto number = whole_number(port, std::numeric_limits<std::uint16_t>::max());
  const bool brackets = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (brackets) {
    host = host.substr(1, host.size() - 2);
  }
  if (!number || (!brackets && host.find(':') != std::string::npos)) {
    fail("'" + text + "': expected HOST:PORT or a port, for example 127.0.0.1:5020");
  }
  return {host.empty() ? kLoopback : host, static_cast<std::uint16_t>(*number)};
}

TcpAddress parse_listening_address(const std::string& text) {
  TcpAddress address = parse_tcp_address(text);
  if (address.host == "localhost") {
    address.host = kLoopback;
  }
  boost::system::error_code error;
  boost::asio::ip::make_address(address.host, error);
  if (error) {
    fail("'" + text + "': expected a numeric address or localhost as HOST, for example 127.0.0.1:5020");
  }
  return address;
}

}  // namespace ex9000::sim
