// Images, and the messages of a master that sends them.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/update/request.hpp"
#include "firmware/update/signature.hpp"
#include "firmware/update/slot.hpp"

namespace ex9000::update {

using Buffer = std::vector<std::uint8_t>;

inline const Model& the_model() { return *find_model("EX9042D-M"); }
constexpr std::string_view kTestBoard = "pico";

inline void append(Buffer& to, std::uint32_t value, unsigned bytes) {
  for (unsigned i = bytes; i != 0; --i) {
    to.push_back(static_cast<std::uint8_t>(value >> (8U * (i - 1))));
  }
}

/// The information block of `image`.
inline Buffer info_of(const Buffer& image, std::uint16_t version = 0x0101, std::uint16_t flags = 0) {
  const Signature signature = signature_of(the_model(), kTestBoard);
  Buffer info(signature.begin(), signature.end());
  append(info, static_cast<std::uint32_t>(image.size()), 4);
  append(info, version, 2);
  append(info, flags, 2);
  append(info, crc32({image.data(), image.size()}), 4);
  info.resize(kInfoSize);
  return info;
}

inline Buffer block_of(const Buffer& image, std::uint32_t offset) {
  Buffer block;
  append(block, offset, 4);
  for (std::uint32_t i = offset; i < offset + kBlockSize; ++i) {
    block.push_back(i < image.size() ? image[i] : 0xFF);
  }
  append(block, crc32({block.data(), block.size()}), 4);
  return block;
}

/// Each byte differs from its neighbours, and one image from the next.
inline Buffer image_of(std::size_t size, std::uint8_t seed = 1) {
  Buffer image(size);
  for (std::size_t i = 0; i < size; ++i) {
    image[i] = static_cast<std::uint8_t>(seed + i + i / 251);
  }
  return image;
}

}  // namespace ex9000::update
