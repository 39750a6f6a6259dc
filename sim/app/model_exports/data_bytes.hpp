// The content of the two data bytes of DCON replies, (First) and (Second), and the values of the status byte.
#pragma once

#include <cstddef>
#include <string>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// Describes data byte 0 or 1, for example `DO8-12`; returns `00` if the byte contains no channel.
std::string data_byte(const Model& model, std::size_t byte);

/// Returns the values that `~AA0` can return on this model.
constexpr const char* status_readings(const Model& model) {
  return model.status_style == StatusStyle::TimeoutOnly ? "00, 04" : "00, 80, 84";
}

}  // namespace ex9000::sim
