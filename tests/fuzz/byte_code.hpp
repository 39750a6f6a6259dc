// The format of the inputs of rtu_stream and dcon_stream. An input describes the events that affect a module.
#pragma once

#include <cstddef>
#include <cstdint>

#include "tests/fuzz/session.hpp"

namespace ex9000::fuzz {

/// Plays an input on a module of `model`. Aborts if the module makes an error. Has no effect if the input has
/// fewer than two bytes.
///
/// The caller selects `model` by byte 0. Byte 1 selects the module's stored settings and its state at the
/// start:
///
///     bits 0-2   baud code. 0 to 4: 06 (9600) to 0A; 5 to 7: 03 to 05
///     bit 3      checksum
///     bit 4      counters count rising edges; in an -M model, a gap of more than T1.5 also spoils a Modbus
///                frame (EX9000_STRICT_GAPS in wire.md 7)
///     bit 5      host watchdog enabled, timeout 0.3 s. On a model with outputs: power-on value 3, safe
///                value 4
///     bit 6      on a model with two protocols, the protocol that is not `usual`
///     bit 7      INIT* connected to GND
///
/// Each of the other bytes is a byte on the line, and there is no gap before it. Exception: `\` begins one of
/// the following codes. N is the value of one byte, or 0 if the input ends before this byte. The codes `\s`,
/// `\g` and `\w` are gaps.
///
///     \\      the byte 5C
///     \c      in Modbus the CRC, in ASCII the checksum if it is enabled, of the bytes since the last gap,
///             reset or (in ASCII) CR
///     \s      250 ms without a byte
///     \g N    a gap of N/64 times T3.5
///     \w N    N times N ms without a byte
///     \f      the next byte arrives with a framing error
///     \y      the next byte arrives with wrong parity
///     \b      the next byte arrives as a break
///     \o      the next byte arrives with an overrun
///     \p N    the previous byte arrives N more times; 00 arrives if there was no byte since the last gap,
///             reset or (in ASCII) CR
///     \h N    the main loop does nothing for the next N times 0.1 ms
///     \0-\7   input 0 to 7 changes its level
///     \t      a tick
///     \i      INIT* is connected to GND, or disconnected; then a tick
///     \m      the memory stops acknowledging, or acknowledges again
///     \r      a reset, by a power cycle
///
/// `\c` and `\p` use only the first 260 bytes since the last gap, reset or (in ASCII) CR. If `\` and the byte
/// after it are not a code of this list, both have no effect. A `\` at the end of the input has no effect.
void live(const Model& model, Protocol usual, const std::uint8_t* data, std::size_t size);

/// Mutates the input with libFuzzer. If `seed` is a multiple of four, also puts `\c` before gaps (if
/// `modbus`) or before CRs (otherwise). `most`: the greatest permitted size. Returns the new size in bytes.
std::size_t mutate(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed, bool modbus);

}  // namespace ex9000::fuzz
