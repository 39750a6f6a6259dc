// Finds the module that a command line names.
#pragma once

#include <optional>
#include <string>

#include "sim/text/words.hpp"
#include "sim/utility/device/device.hpp"

namespace ex9000::utility {

enum class Speaks : std::uint8_t { Unknown, Ascii, Modbus };

/// `text`: an address, as 10 or 0x0A, or a serial number with 8 hex digits. Unknown: asks in Modbus, then in
/// ASCII, with and without a checksum. Throws std::invalid_argument if it is neither; Failed if there is no
/// reply within `patience`, with what the line shows instead: it tries all other modes, and says so; what
/// Connection throws.
Device find_device(Environment& environment, MasterLine& line, const std::string& text, Speaks speaks,
                   Time patience = std::chrono::milliseconds(200));

/// `texts`: modules as above, several separated by commas, or ranges of addresses as 5-9. Returns each in one
/// form: a decimal address, or a serial number in capitals. Throws std::invalid_argument if one is there
/// twice.
sim::Words expand_modules(const sim::Words& texts);

/// Any module replies to it: function 46, sub-function 00 (manuals), reads the code; other devices refuse it.
const Request& harmless_request();

/// A DCON reply with an address is one of another module if it has another, for example a late one.
bool is_reply_of(const std::optional<std::string>& reply, std::uint8_t address);

/// Nobody replies at this address, in either protocol, and nothing else is heard. In the mode of the line.
bool is_free(MasterLine& line, std::uint8_t address);

/// Throws std::invalid_argument: 0 to 255.
std::uint8_t parse_address(const std::string& text);

}  // namespace ex9000::utility
