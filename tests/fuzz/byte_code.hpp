// What happens to a module, as a fuzzer's input says it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "tests/fuzz/session.hpp"

namespace ex9000::fuzz {

/// Byte 0 chooses the model, byte 1 what the module has stored and how it comes up:
///
///     bits 0-2   baud code, 0: 06 (9600), 1: 07, and so on up to 0A, then 03
///     bit 3      checksum
///     bit 4      counters on the rising edge; on -M models strict gaps too
///     bit 5      host watchdog enabled with 0.3 s, outputs: power-on value 3, safe value 4
///     bit 6      where the model has two protocols, the other one than `usual`
///     bit 7      INIT* tied to GND
///
/// The rest is bytes on the line, one behind the other without a gap, but for `\`:
///
///     \\      the byte 5C
///     \c      the check over the bytes since the last gap or CR: CRC, or checksum where it is in force
///     \s      250 ms of silence
///     \g N    a gap of N/64 times T3.5
///     \w N    N times N ms of silence
///     \f \b \o   the next byte comes with a framing error, as a break, with an overrun
///     \p N    the byte before, N times more
///     \h N    the main loop does nothing for the next N times 0.1 ms
///     \0 to \7   input 0 to 7 changes its level
///     \t      a tick
///     \i      INIT* is tied to GND, or released
///     \m      the memory does not answer any more, or does again
///     \r      a reset
///
/// and `\` with anything else is nothing.
void live(const Model& model, Protocol usual, const std::uint8_t* data, std::size_t size);

/// A mutation by libFuzzer; now and then the check of what stands before a gap or a CR is made right.
std::size_t mutate(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed, bool modbus);

}  // namespace ex9000::fuzz
