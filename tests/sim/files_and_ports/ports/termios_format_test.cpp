// Tests the flags of line formats (POSIX.1-2017, 11.2.4).
#include "sim/files_and_ports/ports/termios_format.hpp"

#include <gtest/gtest.h>

namespace ex9000::sim {
namespace {

TEST(TermiosFormats, AreTheStopBitsAndTheParity) {
  EXPECT_EQ(kTermiosFormat, static_cast<tcflag_t>(CSTOPB) | static_cast<tcflag_t>(PARENB) | PARODD);
  EXPECT_EQ(termios_format(LineFormat::k8N1), 0U);
  EXPECT_EQ(termios_format(LineFormat::k8N2), static_cast<tcflag_t>(CSTOPB));
  EXPECT_EQ(termios_format(LineFormat::k8E1), static_cast<tcflag_t>(PARENB));
  EXPECT_EQ(termios_format(LineFormat::k8O1), static_cast<tcflag_t>(PARENB | PARODD));
}

}  // namespace
}  // namespace ex9000::sim
