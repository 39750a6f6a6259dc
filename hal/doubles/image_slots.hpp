#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/update/boot.hpp"
#include "hal/doubles/virtual_clock.hpp"
#include "hal/image_slots.hpp"

namespace ex9000::hal::doubles {

/// Two slots, and the boot loader. Slot 0 has a confirmed image of this version at first. An erase takes
/// 45 ms, a program operation 0.4 ms.
class ImageSlots {
 public:
  /// The board in signatures: images for a Pico are accepted.
  static constexpr std::string_view kBoard = "pico";
  static constexpr VirtualTime kErase = std::chrono::milliseconds(45);
  static constexpr VirtualTime kProgram = std::chrono::microseconds(400);

  ImageSlots(const VirtualClock& clock, const Model& model);

  /// At each start of the module, first: what the boot loader does. False: no image may start.
  bool boot();
  /// Of the image that `boot` has chosen; nn.nn in BCD.
  [[nodiscard]] std::uint16_t version() const;
  [[nodiscard]] bool unconfirmed() const;

  [[nodiscard]] update::Origin origin() const;
  void start(const update::SlotJob& job, Time now);
  /// The job ends in `run` instead.
  bool poll(Time /*now*/) { return false; }
  [[nodiscard]] bool busy() const { return ends_ != kNever; }

  [[nodiscard]] VirtualTime next() const { return ends_; }
  void run();
  /// Ends the job as a power failure does, and at a reset of the MCU too, although a real flash would go on.
  void cut();

  /// From now on, no program operation changes anything.
  void fail(bool on) { failing_ = on; }
  /// Contents of a slot; what is beyond the end is erased.
  std::vector<std::uint8_t>& contents(unsigned slot) { return contents_[slot]; }

  // --- for update::choose ---

  [[nodiscard]] update::SlotHead head(unsigned slot) const;
  [[nodiscard]] bool load(unsigned slot, const update::Info& info) const;
  bool mark_tried(unsigned slot);

 private:
  [[nodiscard]] std::uint8_t at(unsigned slot, std::uint32_t offset) const;
  void program(unsigned slot, std::uint32_t offset, Bytes bytes);
  void erase(unsigned slot, std::uint32_t offset, std::uint8_t kept_bits);

  const VirtualClock& clock_;
  std::array<std::vector<std::uint8_t>, update::kSlots> contents_;
  std::array<update::SlotHead, update::kSlots> heads_{};  ///< at the last `boot`
  unsigned running_ = 0;
  update::SlotJob job_;
  VirtualTime ends_ = kNever;
  bool failing_ = false;
};

}  // namespace ex9000::hal::doubles
