// The images in the two slots of the reference, and how far an update has come: extensions.md, firmware
// update.
#pragma once

#include <cstdint>
#include <memory>
#include <tuple>
#include <vector>

namespace ex9000::reference {

/// The values of register 0x1010.
enum class UpdateState : unsigned { None, Receiving, Complete, Pending, Unconfirmed, TakenBack, Failed };

/// An image that an update has brought, or the one from before all updates.
struct Image {
  std::vector<std::uint8_t> begin;  ///< the 32 bytes that have announced it; none: from before all updates
  std::shared_ptr<const std::vector<std::uint8_t>> content;  ///< the blocks that have come; null: none

  [[nodiscard]] unsigned length() const;
  /// nn.nn in BCD.
  [[nodiscard]] unsigned version() const;
  [[nodiscard]] bool activates_when_complete() const;
  /// Of the blocks that have come.
  [[nodiscard]] unsigned size() const { return content ? static_cast<unsigned>(content->size()) : 0; }
  /// Returns whether these bytes are in a block that has come.
  [[nodiscard]] bool contains(unsigned offset, const std::vector<std::uint8_t>& bytes) const;
  [[nodiscard]] bool crc_is_right() const;

  friend bool operator==(const Image& a, const Image& b) {
    return a.begin == b.begin && a.size() == b.size() &&
           (a.content == b.content || a.size() == 0 || *a.content == *b.content);
  }
};

struct Update {
  UpdateState state = UpdateState::None;
  Image running;
  Image spare;
  bool activates = false;    ///< complete, and the module is about to activate it by itself
  bool answered = false;     ///< not confirmed: has answered a request
  unsigned periods = 0;      ///< not confirmed: periods of 60 s that are over
  std::uint64_t starts = 0;  ///< transfers so far, which tells a begin that starts one

  /// What a reset leaves. If the state is Pending, it starts the new image.
  [[nodiscard]] Update after_reset() const;
  /// The spare slot is empty.
  [[nodiscard]] Update erased() const;

  friend bool operator==(const Update& a, const Update& b) {
    const auto members = [](const Update& u) {
      return std::tie(u.state, u.running, u.spare, u.activates, u.answered, u.periods);
    };
    return members(a) == members(b);
  }
};

/// The CRC-32 of IEEE 802.3 of the first `count` bytes.
std::uint32_t crc32(const std::vector<std::uint8_t>& bytes, std::size_t count);

}  // namespace ex9000::reference
