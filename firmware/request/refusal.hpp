// Why a module refuses a request.
#pragma once

#include <cstdint>

namespace ex9000 {

/// Why a request is refused. The module carries out no action of it.
enum class Refusal : std::uint8_t {
  None,
  // ASCII: the reply is `?AA` or `?` (wire.md section 3)
  UnknownCommand,  ///< no command of this model has this syntax
  OutOfRange,      ///< an argument has a wrong form, is out of range, or contradicts a stored setting
  NotPermitted,    ///< the configuration permission is missing (wire.md section 2); Modbus: 04
  NoSample,        ///< `$AA4` before the first `#**`
  // Modbus exceptions; modbus.cpp maps these reasons to exception codes
  UnknownFunction,     ///< 01
  UnknownSubfunction,  ///< 01 in functions 08 and 2B, 02 in function 46
  WrongLength,         ///< 03; also if the byte count does not match the quantity or the length
  WrongQuantity,       ///< 03
  WrongCoilValue,      ///< 03: function 05 with a value other than FF00 and 0000
  WrongAddress,        ///< 02
  WrongValue,          ///< 03; in ASCII, the reply to `~AAX` is `?AA`
  UnknownObject,       ///< 02, in function 2B/0E
  // both protocols
  OutputsBlocked,  ///< ASCII `!`, Modbus 04: the timeout status is set
  StoreFailed,     ///< ASCII `?AA`, Modbus 04: the memory did not store the settings
  UpdateRefused,   ///< Modbus 04: not this image, not now, or the flash failed (extensions.md, firmware
                   ///< update)
};

}  // namespace ex9000
