// The images that tests run, and their names.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "tests/mcu_model/image.hpp"

namespace ex9000::registers {

/// Loads an image. `board` is the name of the board's folder, and `model` is the rest of the image's
/// name.
inline const Image& image_of(const std::string& board, const std::string& model) {
  return load_image(std::string(EX9000_IMAGES) + "/image_" + board + "_" + model + ".so");
}

struct ImageName {
  const char* board;
  const char* model;
};

/// Returns the name of a parameter, for INSTANTIATE_TEST_SUITE_P.
inline std::string name_of(const testing::TestParamInfo<ImageName>& info) {
  std::string name = std::string(info.param.board) + "_" + info.param.model;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char each) { return std::isalnum(each) == 0; }, '_');
  return name;
}

}  // namespace ex9000::registers
