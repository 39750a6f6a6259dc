// The names of this machine's loopback interface, as browsers write them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>

namespace ex9000::sim {

/// The names under which a browser on this machine may reach a server at a port. A request with any other
/// name may come from a page of another site, even if that name resolves to this machine.
class Loopback {
 public:
  explicit Loopback(std::uint16_t port) : port_(":" + std::to_string(port)), is_usual_(port == kUsualPort) {}

  /// Returns whether `host`, the value of the Host header, is one of these names with the port. At port 80,
  /// the name alone is accepted too.
  [[nodiscard]] bool is_host(std::string_view host) const {
    return std::any_of(std::begin(kNames), std::end(kNames), [&](std::string_view name) {
      return host == std::string(name) + port_ || (is_usual_ && host == name);
    });
  }
  /// Returns whether `origin`, the value of the Origin header, belongs to a page of this server.
  [[nodiscard]] bool is_origin(std::string_view origin) const {
    constexpr std::string_view kScheme = "http://";
    return origin.substr(0, kScheme.size()) == kScheme && is_host(origin.substr(kScheme.size()));
  }

 private:
  static constexpr std::string_view kNames[] = {"127.0.0.1", "localhost"};
  static constexpr std::uint16_t kUsualPort = 80;  ///< the default port of HTTP, which browsers omit

  std::string port_;
  bool is_usual_;
};

}  // namespace ex9000::sim
