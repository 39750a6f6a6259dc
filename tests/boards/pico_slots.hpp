// The fixture of the tests of images in the two slots of a Pico's flash.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "boards/rp2040/memory.hpp"
#include "firmware/update/slot.hpp"
#include "tests/boards/pico_image.hpp"

namespace ex9000::pico {

using play::Bytes;
using update::kImageAt;
using update::kMarksAt;

inline constexpr const char* kModel = "EX9043D-M";
inline constexpr const char* kOldVersion = "D01.00";
inline constexpr const char* kNewVersion = "D02.34";

/// What a slot contains.
struct Content {
  Bytes head;
  Bytes image;

  [[nodiscard]] update::Slot slot() const { return update::Slot({head.data(), head.size()}); }
  std::uint8_t& mark(unsigned which) { return head[kMarksAt + which]; }
  /// The address of the handler of an exception, which is odd.
  [[nodiscard]] std::uint32_t handler(unsigned exception) const {
    return ex9000::Bytes{image.data(), image.size()}.low_byte_first_32(4U * exception);
  }
  void replace_first_instruction(unsigned exception, std::uint16_t instruction) {
    const std::size_t at = handler(exception) - 1U - board::kImageInRam;
    image[at] = static_cast<std::uint8_t>(instruction);
    image[at + 1] = static_cast<std::uint8_t>(instruction >> 8U);
  }
  /// Makes the header right again.
  void seal(std::uint32_t sequence) {
    update::Info info = slot().info;
    const std::uint32_t crc = update::crc32({image.data(), image.size()});
    for (unsigned i = 0; i < 4; ++i) {
      info.bytes[update::kLengthAt + i] = static_cast<std::uint8_t>(image.size() >> (24 - 8 * i));
      info.bytes[update::kImageCheckAt + i] = static_cast<std::uint8_t>(crc >> (24 - 8 * i));
    }
    const update::Header sealed = update::header_of(info, sequence);
    std::copy(sealed.begin(), sealed.end(), head.begin());
  }
};

class PicoSlots : public PicoImage {
 protected:
  /// The supply is off. Slot 0 has the image of the build, and slot 1 none.
  explicit PicoSlots(const char* model = kModel) {
    begin(model);
    bench_.power(false);
    old_ = {flash(0, 0, update::kSlotHeadSize), {}};
    old_.image = flash(0, kImageAt, old_.slot().info.length());
    new_ = old_;
    const std::string version = kOldVersion;
    auto& image = new_.image;
    for (auto found = image.begin();
         (found = std::search(found, image.end(), version.begin(), version.end())) != image.end();) {
      found = std::copy_n(kNewVersion, version.size(), found);
    }
    new_.seal(2);
  }

  static std::string address_of(unsigned slot, std::uint32_t offset) {
    return std::to_string(board::kSlotsInFlash + slot * update::kSlotSize + offset);
  }
  Bytes flash(unsigned slot, std::uint32_t offset, std::size_t size) {
    const std::string hex = bench_.execute("flash " + address_of(slot, offset) + " " + std::to_string(size));
    Bytes bytes;
    for (std::size_t i = 0; i < hex.size(); i += 2) {
      bytes.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
    }
    return bytes;
  }
  void put(unsigned slot, const Content& content) {
    set_flash(address_of(slot, 0), content.head);
    set_flash(address_of(slot, kImageAt), content.image);
  }
  void set_flash(const std::string& address, const Bytes& bytes) {
    std::string command = "set-flash " + address + " ";
    constexpr const char* kDigits = "0123456789abcdef";
    for (const std::uint8_t byte : bytes) {
      command += kDigits[byte >> 4U];
      command += kDigits[byte & 0xFU];
    }
    bench_.execute(command);
  }
  std::uint8_t mark(unsigned slot, unsigned which) { return flash(slot, kMarksAt + which, 1)[0]; }

  /// Starts the module. Returns the version of the image that runs after `kComingUp`, or "" if none does.
  std::string version_after(const char* start) {
    bench_.execute(start);
    bench_.come_up();
    bench_.heard();
    const std::string reply = ask("$01F");
    return reply.empty() ? "" : reply.substr(3, reply.size() - 4);
  }
  std::string version_after_power_on() {
    bench_.power(false);
    bench_.power(true);
    return version_after("heard");
  }

  Content old_;
  Content new_;
};

}  // namespace ex9000::pico
