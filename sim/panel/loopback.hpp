// The names of this machine's own loopback, as browsers write them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>

namespace ex9000::sim {

/// Names that a browser on this machine may know a server at a port by. Another one, though it leads here, is
/// a foreign site's.
class Loopback {
 public:
  explicit Loopback(std::uint16_t port) : port_(":" + std::to_string(port)), is_usual_(port == kUsualPort) {}

  /// `host`: what Host says.
  [[nodiscard]] bool is_host(std::string_view host) const {
    return std::any_of(std::begin(kNames), std::end(kNames), [&](std::string_view name) {
      return host == std::string(name) + port_ || (is_usual_ && host == name);
    });
  }
  /// `origin`: what Origin says.
  [[nodiscard]] bool is_origin(std::string_view origin) const {
    constexpr std::string_view kScheme = "http://";
    return origin.substr(0, kScheme.size()) == kScheme && is_host(origin.substr(kScheme.size()));
  }

 private:
  static constexpr std::string_view kNames[] = {"127.0.0.1", "localhost"};
  static constexpr std::uint16_t kUsualPort = 80;  ///< of HTTP: browsers leave it out

  std::string port_;
  bool is_usual_;
};

}  // namespace ex9000::sim
