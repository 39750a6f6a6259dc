#include "sim/files_and_ports/ports/termios_rates.hpp"

#include <array>
#include <utility>

namespace ex9000::sim {

namespace {

/// All rates for which Linux has a termios constant. Modules support only some of them.
constexpr std::array<std::pair<speed_t, std::uint32_t>, 30> kSpeeds{
    {{B50, 50},           {B75, 75},           {B110, 110},         {B134, 134},
     {B150, 150},         {B200, 200},         {B300, 300},         {B600, 600},
     {B1200, 1200},       {B1800, 1800},       {B2400, 2400},       {B4800, 4800},
     {B9600, 9600},       {B19200, 19200},     {B38400, 38400},     {B57600, 57600},
     {B115200, 115200},   {B230400, 230400},   {B460800, 460800},   {B500000, 500000},
     {B576000, 576000},   {B921600, 921600},   {B1000000, 1000000}, {B1152000, 1152000},
     {B1500000, 1500000}, {B2000000, 2000000}, {B2500000, 2500000}, {B3000000, 3000000},
     {B3500000, 3500000}, {B4000000, 4000000}}};

}  // namespace

std::optional<speed_t> termios_speed(std::uint32_t baud) {
  for (const auto& [speed, rate] : kSpeeds) {
    if (rate == baud) {
      return speed;
    }
  }
  return std::nullopt;
}

tcflag_t termios_format(LineFormat format) {
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
