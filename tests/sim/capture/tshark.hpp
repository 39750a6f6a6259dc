// What Wireshark makes of a capture.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace ex9000::system {

/// A packet: what was asked for, by field; more than one of a kind with commas between.
using Packet = std::map<std::string, std::string>;

/// All packets of a capture, as README's command decodes them. Fails the test where tshark finds fault with
/// the file.
std::vector<Packet> decoded(const std::string& path, const std::vector<std::string>& fields);

}  // namespace ex9000::system
