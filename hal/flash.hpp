// A NOR flash, for example a W25Q16JV. An erase sets all bits of a sector to 1. A program operation changes
// ones to zeros. The flash carries out one operation at a time while the main loop continues. An address is
// an offset in the flash, in bytes. All functions are for the main loop and do not wait for the flash.
//
//     void start_erase(std::uint32_t address)
//         Begins to erase the sector that begins at `address`. This takes 45 ms typically and 400 ms at
//         most. Call it only while not `busy()` and while no erase is suspended.
//     void start_program(std::uint32_t address, Bytes source)
//         Begins to program `source`. This takes 0.4 ms typically and 3 ms at most. Call it only while not
//         `busy()`. The erase of another sector may be suspended. `source` need not stay valid after the
//         call.
//     bool busy()
//         Returns whether the flash is erasing or programming. A suspended erase does not make it busy.
//     void suspend()
//         Suspends an erase, so that `busy()` is false after at most 20 us. Then other sectors can be read
//         and programmed. Has no effect on a flash that is not busy. Do not call it during a program
//         operation, or less than 20 us after `resume`.
//     void resume()
//         Continues a suspended erase, so that the flash is `busy()`. Has no effect if no erase is
//         suspended. Call it only while not `busy()`.
//     void read(std::uint32_t address, MutableBytes destination)
//         Reads `destination.size` bytes from `address` on. Call it only while not `busy()`.
//
// A reset of the MCU does not affect an operation that is running or suspended. A power failure ends the
// operation: the bytes to program, or all bytes of the sector to erase, then have undefined values.
//
// The times are those of the W25Q16JV data sheet: 8.2, "Page Program (02h)", "Sector Erase (20h)" and
// "Erase / Program Suspend (75h)", and "AC electrical characteristics" (tPP, tSE, tSUS).
#pragma once

#include <cstdint>

namespace ex9000::hal {

/// The unit of an erase, in bytes.
inline constexpr std::uint32_t kFlashSector = 4096;
/// The size of a page, in bytes. A program operation must not cross the end of a page.
inline constexpr std::uint32_t kFlashPage = 256;

}  // namespace ex9000::hal
