// Tests when the program removes a new file that it has created.
#include "sim/files_and_ports/files/new_file.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/directory.hpp"

namespace ex9000::sim {
namespace {

using system::Directory;
using system::write_file;

/// Writes a file at `path` as the program does, and calls NewFile::keep if `keep` is true.
void make(const std::string& path, bool keep) {
  NewFile file(path, is_there(path));
  write_file(path, "new");
  if (keep) {
    file.keep();
  }
}

TEST(NewFile, IsRemovedUnlessItIsKept) {
  const Directory directory;
  make(directory / "a", false);
  EXPECT_FALSE(is_there(directory / "a"));
  make(directory / "a", true);
  EXPECT_TRUE(is_there(directory / "a"));
}

TEST(NewFile, AFileThatWasThereIsNotRemoved) {
  const Directory directory;
  write_file(directory / "a", "old");
  make(directory / "a", false);
  EXPECT_TRUE(is_there(directory / "a"));
}

}  // namespace
}  // namespace ex9000::sim
