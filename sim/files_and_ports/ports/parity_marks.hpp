// The marks with which a serial port reports bytes with line errors: wrong parity or a framing error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ex9000::sim {

/// Of a port with the flags INPCK and PARMRK (POSIX.1-2017, 11.2.2), in hex: FF 00 X is a byte X with a line
/// error, FF FF is a byte FF. A mark may be split between two calls of `read`.
class ParityMarks {
 public:
  struct Arrived {
    std::uint8_t byte;
    bool damaged;

    friend bool operator==(Arrived a, Arrived b) { return a.byte == b.byte && a.damaged == b.damaged; }
  };

  std::vector<Arrived> read(const std::uint8_t* bytes, std::size_t size) {
    std::vector<Arrived> arrived;
    for (std::size_t i = 0; i < size; ++i) {
      if (state_ == State::Plain && bytes[i] == kMark) {
        state_ = State::AfterMark;
      } else if (state_ == State::AfterMark && bytes[i] == 0) {
        state_ = State::BeforeDamaged;
      } else {
        arrived.push_back({bytes[i], state_ == State::BeforeDamaged});
        state_ = State::Plain;
      }
    }
    return arrived;
  }

 private:
  enum class State : std::uint8_t { Plain, AfterMark, BeforeDamaged };
  static constexpr std::uint8_t kMark = 0xFF;

  State state_ = State::Plain;
};

}  // namespace ex9000::sim
