// Decodes captures with tshark, the command-line program of Wireshark.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace ex9000::system {

/// The values of the requested fields of a packet, by the name of the field. Several values of one field are
/// separated by commas.
using Packet = std::map<std::string, std::string>;

/// Decodes all packets of a capture with the preferences (`-o`) of the example in sim/docs/capture.md. Fails
/// the test if tshark fails or reports that the file is incomplete or damaged.
std::vector<Packet> decoded(const std::string& path, const std::vector<std::string>& fields);

/// Expects that `packet` has the values of `wanted`. The packet may also have values of other fields.
void expect_shown(const Packet& packet, const Packet& wanted);

}  // namespace ex9000::system
