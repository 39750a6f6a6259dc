// Random steps for a session, made for what the reference is at the moment: its protocol, address, checksum,
// model.
#pragma once

#include "tests/oracles/reference/random.hpp"
#include "tests/oracles/reference/session.hpp"

namespace ex9000::reference {

/// What a session begins with: nothing, or a person who gives a module another address, rate, checksum and
/// protocol through INIT*, which random steps do in that order but seldom.
std::vector<Step> first_steps(const ModelRow& row, Random& random);

/// What comes next: mostly a request.
Step next_step(const Module& module, Random& random);

/// CR, and CHK before it where the module has it on.
Bytes dcon_request(const Module& module, Random& random);

/// With its CRC, mostly.
Bytes modbus_request(const Module& module, Random& random);

}  // namespace ex9000::reference
