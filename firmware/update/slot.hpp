// An image slot: its layout, and which one starts. For the module, the boot loader and the simulator.
//
//     sector 0           header, at 0: what and how long the image is
//                        marks, from kMarksAt on: one byte each, FF until something is true for ever, then 00
//     sectors 1 to 31    the image
//
// A mark is programmed after what it says has become true. If the power fails meanwhile, it may read as set
// or not, and may change by itself, but what it says is true: it can be programmed again. One case remains: a
// mark of a sector reads as not set, the sector is written again, the power fails once more, and the mark has
// changed. Then the CRC of the image shows it at the end of the transfer, which begins anew.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/bytes.hpp"
#include "firmware/settings/crc32.hpp"

namespace ex9000::update {

constexpr std::string_view kBootLoaderVersion = "1.0";

constexpr unsigned kSlots = 2;
constexpr std::uint32_t kSector = 4096;  ///< unit of an erase, in bytes
constexpr std::uint32_t kSlotSize = 128 * 1024;
constexpr std::uint32_t kImageAt = kSector;
/// An image is received in blocks of this size.
constexpr std::uint32_t kBlockSize = 128;
constexpr std::uint32_t kLargestImage = kSlotSize - kImageAt;
constexpr std::uint32_t kImageSectors = kLargestImage / kSector;

constexpr std::uint32_t sectors_of(std::uint32_t length) { return (length + kSector - 1) / kSector; }

/// The information block: registers 0x1000 to 0x100F (extensions.md, firmware update).
constexpr std::size_t kInfoSize = 32;
constexpr std::size_t kSignatureSize = 12;
constexpr std::uint16_t kActivateWhenComplete = 1;

constexpr std::size_t kLengthAt = kSignatureSize;
constexpr std::size_t kVersionAt = 16;
constexpr std::size_t kFlagsAt = 18;
constexpr std::size_t kImageCheckAt = 20;
constexpr std::size_t kReservedAt = 24;

struct Info {
  std::array<std::uint8_t, kInfoSize> bytes{};

  [[nodiscard]] Bytes all() const { return {bytes.data(), bytes.size()}; }
  /// Board and model that the image is for, padded with 0.
  [[nodiscard]] Bytes signature() const { return all().first(kSignatureSize); }
  [[nodiscard]] std::uint32_t length() const {
    return all().double_word(kLengthAt);
  }                                                                               ///< of the image, in bytes
  [[nodiscard]] std::uint16_t version() const { return all().word(kVersionAt); }  ///< nn.nn in BCD
  [[nodiscard]] std::uint16_t flags() const { return all().word(kFlagsAt); }
  [[nodiscard]] std::uint32_t check() const {
    return all().double_word(kImageCheckAt);
  }                                                                         ///< CRC-32 of the image
  [[nodiscard]] Bytes reserved() const { return all().from(kReservedAt); }  ///< all 0
};

/// The header: kMagic, the sequence number, Info, and the CRC-32 of all these; numbers high byte first.
constexpr std::string_view kMagic = "EX9SLOT1";
constexpr std::size_t kSequenceAt = 8;
constexpr std::size_t kInfoAt = 12;
constexpr std::size_t kCheckAt = kInfoAt + kInfoSize;
constexpr std::size_t kHeaderSize = kCheckAt + 4;

constexpr std::size_t kMarksAt = 64;
constexpr std::uint8_t kMarked = 0x00;
/// Offset of a mark from kMarksAt. Sectors have the first ones: programmed, and read back.
enum Mark : std::uint8_t {
  kActivated = 32,  ///< the image is complete and verified, and may start
  kTried,           ///< set by the boot loader before it starts an image that is not confirmed
  kConfirmed,       ///< the image has proved itself
};
static_assert(kImageSectors <= kActivated);

/// Of a slot, its first bytes: header and marks.
constexpr std::size_t kSlotHeadSize = 128;
using SlotHead = std::array<std::uint8_t, kSlotHeadSize>;
/// Over the beginning of a header, these make it invalid.
constexpr std::array<std::uint8_t, 8> kNoMagic{};
static_assert(kNoMagic.size() == kMagic.size());

inline std::uint32_t crc32(Bytes bytes) {
  Crc32 crc;
  for (const std::uint8_t byte : bytes) {
    crc.add(byte);
  }
  return crc.value();
}

using Header = std::array<std::uint8_t, kHeaderSize>;
Header header_of(const Info& info, std::uint32_t sequence);

/// What a slot says about itself.
struct Slot {
  explicit Slot(Bytes head);
  Slot() = default;

  bool valid = false;          ///< the header is right; else nothing in this slot counts
  std::uint32_t sequence = 0;  ///< higher: newer
  Info info;
  std::uint32_t sectors = 0;  ///< that have been received
  bool activated = false;
  bool tried = false;
  bool confirmed = false;

  /// If also the CRC of the image is right. An image that is confirmed needs no other mark.
  [[nodiscard]] bool may_start() const { return valid && (confirmed || (activated && !tried)); }
};

/// Which slot the boot loader tries first, then the other one.
inline unsigned first_choice(const Slot& slot_0, const Slot& slot_1) {
  if (slot_0.may_start() && slot_1.may_start()) {
    return slot_0.sequence > slot_1.sequence ? 0 : 1;
  }
  return slot_0.may_start() ? 0 : 1;
}

}  // namespace ex9000::update
