// What the two data bytes of DCON replies hold, (First) and (Second).
#pragma once

#include <cstddef>
#include <string>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// Of byte 0 or 1, `DO8-12` say; `00` where it holds no channel.
std::string data_byte(const Model& model, std::size_t byte);

/// The readings that `~AA0` has on this model.
constexpr const char* status_readings(const Model& model) {
  return model.status_style == StatusStyle::TimeoutOnly ? "00, 04" : "00, 80, 84";
}

}  // namespace ex9000::sim
