#include "firmware/update/slot.hpp"

#include <algorithm>

namespace ex9000::update {

namespace {

void put(std::uint32_t value, std::uint8_t* to) {
  constexpr unsigned kBitsAByte = 8;
  for (unsigned i = 4; i != 0; --i) {
    *to++ = static_cast<std::uint8_t>(value >> (kBitsAByte * (i - 1)));
  }
}

}  // namespace

Header header_of(const Info& info, std::uint32_t sequence) {
  Header header{};
  std::copy(kMagic.begin(), kMagic.end(), header.begin());
  put(sequence, &header[kSequenceAt]);
  std::copy(info.bytes.begin(), info.bytes.end(), &header[kInfoAt]);
  put(crc32({header.data(), kCheckAt}), &header[kCheckAt]);
  return header;
}

Slot::Slot(Bytes head)
    : valid(std::equal(kMagic.begin(), kMagic.end(), head.begin()) &&
            head.double_word(kCheckAt) == crc32(head.first(kCheckAt))),
      sequence(head.double_word(kSequenceAt)) {
  std::copy_n(head.begin() + kInfoAt, kInfoSize, info.bytes.begin());
  const Bytes marks = head.from(kMarksAt);
  for (std::uint32_t sector = 0; sector < kImageSectors; ++sector) {
    if (marks[sector] == kMarked) {
      sectors = sector + 1;  // one before it that is not set has decayed: they are set in order
    }
  }
  activated = marks[kActivated] == kMarked;
  tried = marks[kTried] == kMarked;
  confirmed = marks[kConfirmed] == kMarked;
}

}  // namespace ex9000::update
