// The rows of the register map: bits.hpp has the coils and discrete inputs, words.hpp the registers.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/model/model.hpp"
#include "firmware/request/exchange.hpp"

namespace ex9000::registers {

/// The function codes that can access a row; bit n is function n.
using Functions = std::uint16_t;
constexpr Functions kReadCoils = 1U << 0x1U;
constexpr Functions kReadDiscreteInputs = 1U << 0x2U;
constexpr Functions kReadHoldingRegisters = 1U << 0x3U;
constexpr Functions kReadInputRegisters = 1U << 0x4U;
constexpr Functions kWriteSingleCoil = 1U << 0x5U;
constexpr Functions kWriteSingleRegister = 1U << 0x6U;
constexpr Functions kWriteMultipleCoils = 1U << 0xFU;
/// Function 10 (hex), with all registers of the row at once.
constexpr Functions kWriteWholeRow = 1U << 0x0U;
/// Functions 06 and 10 (hex) can always access the same rows.
constexpr Functions kWriteRegisters = kWriteSingleRegister;
constexpr Functions kReadRegisters = kReadHoldingRegisters | kReadInputRegisters;

/// How many coils, discrete inputs or registers a row has.
enum class Width : std::uint8_t {
  One = 1,
  Two = 2,
  Three = 3,
  Eight = 8,
  Twelve = 12,
  Sixteen = 16,
  Twenty = 20,
  SixtyEight = 68,
  PerOutput = 0x80,
  PerInput,
  PairPerInput
};

constexpr unsigned kLargestWidth = 32;

constexpr unsigned width_of(Width width, const Model& model) {
  if (width < Width::PerOutput) {
    return static_cast<unsigned>(width);
  }
  if (width == Width::PerOutput) {
    return model.outputs;
  }
  return width == Width::PairPerInput ? 2U * model.inputs : model.inputs;
}

using Rules = std::uint8_t;
constexpr Rules kPlain = 0;
constexpr Rules kOnlyOn = 1U << 0U;         ///< exception 03 for function 05 with 0000
constexpr Rules kConfiguration = 1U << 1U;  ///< writes by broadcast are ignored
constexpr Rules kExtension = 1U << 2U;      ///< `~AAX` accesses the row too (firmware/extensions.md)
constexpr Rules kLong = 1U << 3U;           ///< pairs of registers with 32-bit values, high word first

struct BitRow {
  std::uint16_t first = 0;
  Width width = Width::One;
  Needs needs = Needs::Nothing;
  Functions functions = 0;
  Rules rules = kPlain;
  /// Bit 0 is the first coil or discrete input of the row.
  std::uint16_t (*read)(const State& state) = nullptr;
  Refusal (*write)(const State& state, BitWrite bits, Outcome& outcome) = nullptr;

  [[nodiscard]] constexpr bool has(Rules rule) const { return (rules & rule) != 0; }
};

struct WordRow {
  std::uint16_t first = 0;
  Width width = Width::One;
  Needs needs = Needs::Nothing;
  Functions functions = 0;
  Rules rules = kPlain;
  /// `index`: position in the row, from 0.
  std::uint16_t (*read)(const Exchange& exchange, unsigned index) = nullptr;
  Refusal (*write)(const State& state, unsigned index, std::uint16_t value, Outcome& outcome) = nullptr;
  /// For kWriteWholeRow. `data`: valid until the request has been judged.
  Refusal (*write_whole)(const State& state, Bytes data, Outcome& outcome) = nullptr;

  [[nodiscard]] constexpr bool has(Rules rule) const { return (rules & rule) != 0; }
};

/// The texts are documentation; an image does not contain them.
struct BitRegister {
  std::string_view id;  ///< identifies the row in exports and test coverage; must not change
  std::string_view meaning;
  std::string_view range;  ///< values that may be written; empty if the row is read-only
  BitRow row;
};

struct WordRegister {
  std::string_view id;
  std::string_view meaning;
  std::string_view range;
  WordRow row;
};

}  // namespace ex9000::registers
