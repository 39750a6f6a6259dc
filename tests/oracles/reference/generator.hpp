// Generates random steps for a session. They suit the current state of the reference module: its protocol,
// address, checksum and model. For a module without extensions, they contain no request that requires an
// extension, except by chance.
#pragma once

#include "tests/oracles/reference/random.hpp"
#include "tests/oracles/reference/session.hpp"

namespace ex9000::reference {

/// Returns the first steps of a session: either none, or the steps by which a person sets another address,
/// baud rate, line format, checksum and protocol through INIT*. Random steps alone rarely have this order.
std::vector<Step> first_steps(const Module& module, Random& random);

/// Returns the next step, in most cases a request.
Step next_step(const Module& module, Random& random);

/// Returns a command with CR, and CHK before it if the module uses the checksum. Some commands have a
/// mistake, or other bytes before them.
Bytes dcon_request(const Module& module, Random& random);

/// Returns a CC with this rate. If the module has extensions, half of the returned CCs have a random line
/// format.
unsigned baud_code_with(unsigned rate, const Module& module, Random& random);

/// Returns the address of an extension register, or one at which this model has none.
unsigned extension_address(const Module& module, Random& random);

/// Returns a value to write to the extension register at this address, in most cases one that it accepts.
unsigned extension_content(const Module& module, unsigned address, Random& random);

/// Returns a frame, in most cases with a correct CRC.
Bytes modbus_request(const Module& module, Random& random);

}  // namespace ex9000::reference
