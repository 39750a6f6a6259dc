// Checks and definitions for all images. Include this file in only one source file of a program, after the
// `board.hpp` of a board. `board.hpp` must define kOutputs and kInputs, which are arrays of pin groups. Each
// pin group must have a member `count`, its number of pins.
#pragma once

#include <iterator>

#include "boards/image_info.hpp"
#include "firmware/model/built.hpp"

namespace ex9000::board {

#ifdef EX9000_IMAGES
static_assert(std::size(kModels) == EX9000_IMAGES,
              "a row of the model table has no image; begin the line of the row with four spaces and {\"EX9 "
              "(boards/CMakeLists.txt finds rows by this pattern)");
#endif

#ifdef EX9000_PRESET
/// boards/CMakeLists.txt defines EX9000_PRESET and EX9000_COMMIT for the image files. Tests compile images
/// for the host without these definitions, so the images for the host do not contain this information.
// NOLINTNEXTLINE(misc-definitions-in-headers): included once
__attribute__((section(".image_info"), used)) constexpr ImageInfo kImageInfo{
    {kImageMark}, {kFirmwareVersion}, {EX9000_PRESET}, {kOnlyModel.designation}, {EX9000_COMMIT}};
#endif

template <class Groups>
constexpr unsigned pins_in(const Groups& groups) {
  unsigned pins = 0;
  for (const auto& group : groups) {
    pins += group.count;
  }
  return pins;
}
static_assert(kOnlyModel.outputs <= pins_in(kOutputs), "this board has too few output pins for the model");
static_assert(kOnlyModel.inputs <= pins_in(kInputs), "this board has too few input pins for the model");
static_assert((kOnlyModel.outputs <= 8 && kOnlyModel.inputs <= 8) || kOnlyModel.outputs == 0 ||
                  kOnlyModel.inputs == 0,
              "outputs and inputs of the model need the same pins of this board");

}  // namespace ex9000::board
