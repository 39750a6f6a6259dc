// Checks whether the headers of a browser's request name this machine's loopback interface.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

namespace ex9000::sim {

/// 127.0.0.1 or localhost, with or without a port. Any other name may come from another site's page, even if
/// it resolves to this machine. The port proves nothing: an SSH tunnel has another one.
inline bool is_loopback_host(std::string_view host) {
  const std::size_t colon = std::min(host.find(':'), host.size());
  const std::string_view name = host.substr(0, colon);
  const std::string_view port = host.substr(std::min(colon + 1, host.size()));
  const auto is_digit = [](unsigned char character) { return std::isdigit(character) != 0; };
  return (name == "127.0.0.1" || name == "localhost") && std::all_of(port.begin(), port.end(), is_digit) &&
         port.empty() == (colon == host.size());
}

/// A page of another server of this machine has another port, and thus another origin.
inline bool is_origin_of(std::string_view origin, std::string_view host) {
  return origin == "http://" + std::string(host);
}

}  // namespace ex9000::sim
