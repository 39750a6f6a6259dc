// Tests that an emulator that does not start is reported at once, with its own error.
#include "tests/qemu/emulator.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "tests/support/directory.hpp"

namespace ex9000::rig {
namespace {

TEST(Emulator, ThatDoesNotStartIsReportedWithItsOwnError) {
  const system::Directory directory;
  system::write_file(directory / "memory", std::string(8192, '\xFF'));
  try {
    const Emulator emulator("/nowhere/EX9042D.elf", directory / "memory");
    FAIL() << "the emulator has started";
  } catch (const std::runtime_error& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.rfind("emulator: it has ended with status 1: ", 0), 0U) << what;
    EXPECT_NE(what.find("/nowhere/EX9042D.elf"), std::string::npos) << what;
  }
}

}  // namespace
}  // namespace ex9000::rig
