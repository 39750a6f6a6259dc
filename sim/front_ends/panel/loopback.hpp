// Checks whether the headers of a browser's request name this machine's loopback interface.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace ex9000::sim {

/// Returns whether `host`, the value of the Host header, is 127.0.0.1 or localhost with the port of the
/// server. At port 80, which browsers omit, the name alone is accepted too. A request with any other name may
/// come from a page of another site, even if that name resolves to this machine.
inline bool is_loopback_host(std::string_view host, std::uint16_t port) {
  constexpr std::uint16_t kUsualPort = 80;
  const auto is_named = [host, port](const std::string& name) {
    return host == name + ":" + std::to_string(port) || (port == kUsualPort && host == name);
  };
  return is_named("127.0.0.1") || is_named("localhost");
}

/// Returns whether `origin`, the value of the Origin header, belongs to a page of the server at `port`.
inline bool is_loopback_origin(std::string_view origin, std::uint16_t port) {
  constexpr std::string_view kScheme = "http://";
  return origin.substr(0, kScheme.size()) == kScheme && is_loopback_host(origin.substr(kScheme.size()), port);
}

}  // namespace ex9000::sim
