// Generates random requests. Most of them suit the model and the current protocol, address
// and checksum of the reference module. For a module without extensions, no request
// requires an extension, except by chance.
#pragma once

#include "tests/oracles/reference/module.hpp"
#include "tests/oracles/reference/random.hpp"

namespace ex9000::reference {

/// Returns a command with CR, and with CHK before the CR if the module uses the checksum. Some commands have
/// a mistake, no CR, or other bytes before them. Some results are only random characters.
Bytes dcon_request(const Module& module, Random& random);

/// Returns a CC with `code` in bits 5:0. `code`: the code of a baud rate, for example 0x06 for 9600 baud, or
/// a code that no baud rate has. If the module has extensions, about half of the returned CCs have a random
/// line format.
unsigned baud_code_with(unsigned code, const Module& module, Random& random);

/// Returns the address of an extension register, or an address at which this model has no such register.
unsigned extension_address(const Module& module, Random& random);

/// Returns a value to write to the extension register at this address. If the register can be written, it
/// accepts the value in most cases.
unsigned extension_content(const Module& module, unsigned address, Random& random);

/// Returns a frame, in most cases with a correct CRC.
Bytes modbus_request(const Module& module, Random& random);

/// A request that sets the filter time of an input.
Bytes filter_request(const Module& module, unsigned channel, Random& random);

}  // namespace ex9000::reference
