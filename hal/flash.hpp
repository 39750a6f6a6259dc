// A NOR flash, for example a W25Q16JV. An erase sets the bits of a sector to 1, a program operation changes
// ones to zeros. One operation at a time, while the main loop continues. Addresses are offsets in bytes. For
// the main loop; nothing waits for the flash. Except `busy` and `suspend`, only while not `busy()`.
//     void start_erase(std::uint32_t address)
//         The sector that begins there: typically 45 ms, at most 400 ms. Not while an erase is suspended.
//     void start_program(std::uint32_t address, Bytes source)
//         Typically 0.4 ms, at most 3 ms. An erase elsewhere may be suspended. `source` need not stay valid.
//     bool busy()       Erasing or programming. A suspended erase does not count.
//     void suspend()    An erase: after at most 20 us, other sectors can be read and programmed. No effect if
//                       not busy. Not while programming, or less than 20 us after `resume`.
//     void resume()     A suspended erase, which makes the flash `busy()`. No effect if there is none.
//     void read(std::uint32_t address, MutableBytes destination)
// A reset of the MCU does not affect an operation, running or suspended. A power failure ends it: the bytes
// to program, or all of the sector to erase, are then undefined. Times: W25Q16JV data sheet, 8.2 (Page
// Program, Sector Erase, Erase / Program Suspend) and "AC electrical characteristics" (tPP, tSE, tSUS).
#pragma once

#include <cstdint>

namespace ex9000::hal {

/// The unit of an erase, in bytes.
inline constexpr std::uint32_t kFlashSector = 4096;
/// In bytes. A program operation must not cross the end of a page.
inline constexpr std::uint32_t kFlashPage = 256;

}  // namespace ex9000::hal
