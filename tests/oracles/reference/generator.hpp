// Generates random steps for a session. Most of them suit the model of the reference module, and its current
// protocol, address and checksum. For a module without extensions, they contain no request that requires an
// extension, except by chance.
#pragma once

#include "tests/oracles/reference/random.hpp"
#include "tests/oracles/reference/session.hpp"

namespace ex9000::reference {

/// Returns the first steps of a session: either none, or the steps by which a person, in INIT mode, sets the
/// address, CC and FF with `%AANNTTCCFF` and, on an -M model, the protocol with `$AAPN`. Random steps alone
/// rarely have this order.
std::vector<Step> first_steps(const Module& module, Random& random);

/// Returns the next step, in most cases a request.
Step next_step(const Module& module, Random& random);

/// Returns a command with CR, and with CHK before the CR if the module uses the checksum. Some commands have
/// a mistake, no CR, or other bytes before them. Some results are only random characters.
Bytes dcon_request(const Module& module, Random& random);

/// Returns a CC with this code of a baud rate in bits 5:0, for example 06 for 9600 baud. The code may be one
/// that does not exist. If the module has extensions, about half of the returned CCs have a random line
/// format.
unsigned baud_code_with(unsigned code, const Module& module, Random& random);

/// Returns the address of an extension register, or one at which this model has none.
unsigned extension_address(const Module& module, Random& random);

/// Returns a value to write to the extension register at this address. If the register can be written, it
/// accepts the value in most cases.
unsigned extension_content(const Module& module, unsigned address, Random& random);

/// Returns a frame, in most cases with a correct CRC.
Bytes modbus_request(const Module& module, Random& random);

}  // namespace ex9000::reference
