// Converts line formats to termios flags.
#pragma once

#include <termios.h>

#include "firmware/model/line_format.hpp"

namespace ex9000::sim {

/// Of `c_cflag`, besides CS8.
constexpr tcflag_t kTermiosFormat = CSTOPB | PARENB | PARODD;
constexpr tcflag_t termios_format(LineFormat format) {
  switch (format) {
    case LineFormat::k8N1:
      return 0;
    case LineFormat::k8N2:
      return CSTOPB;
    case LineFormat::k8E1:
      return PARENB;
    case LineFormat::k8O1:
      return PARENB | PARODD;
  }
  return 0;
}

}  // namespace ex9000::sim
