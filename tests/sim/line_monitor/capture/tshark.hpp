// Decodes captures with tshark, the command-line program of Wireshark.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace ex9000::system {

/// The values of the requested fields of a packet. Several values of one field are separated by commas.
using Packet = std::map<std::string, std::string>;

/// Decodes all packets of a capture with the options that sim/docs/capture.md recommends. Fails the test if
/// tshark reports an error in the file.
std::vector<Packet> decoded(const std::string& path, const std::vector<std::string>& fields);

/// Expects that the packet has these values. The packet may also have values of other fields.
void expect_shown(const Packet& packet, const Packet& wanted);

}  // namespace ex9000::system
