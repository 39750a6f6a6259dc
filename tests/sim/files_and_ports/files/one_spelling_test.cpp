// Tests that different spellings of a path become equal, and that different paths stay different.
#include "sim/files_and_ports/files/one_spelling.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/directory.hpp"

namespace ex9000::sim {
namespace {

namespace fs = std::filesystem;
using system::Directory;

TEST(OneSpelling, IsTheSameForAllSpellingsOfAFolder) {
  const Directory directory;
  fs::create_directory(directory / "a");
  fs::create_directory_symlink(directory / "a", directory / "b");
  const std::string plain = one_spelling(directory / "a/file");
  EXPECT_EQ(one_spelling(directory / "b/file"), plain);
  EXPECT_EQ(one_spelling(directory / "a/./../b//file"), plain);
  EXPECT_EQ(one_spelling("file"), one_spelling("./file"));
  EXPECT_NE(one_spelling(directory / "a/other"), plain);
}

TEST(OneSpelling, DoesNotFollowALinkAtThePathItself) {
  const Directory directory;
  fs::create_symlink(directory / "a", directory / "b");
  EXPECT_NE(one_spelling(directory / "a"), one_spelling(directory / "b"));
}

TEST(OneSpelling, DistinguishesFilesInFoldersThatCannotBeExamined) {
  const Directory directory;
  fs::create_symlink("loop", directory / "loop");
  fs::create_symlink("ring", directory / "ring");
  EXPECT_NE(one_spelling(directory / "loop/file"), one_spelling(directory / "ring/file"));
  EXPECT_EQ(one_spelling(directory / "loop/file"), one_spelling(directory / "loop/file"));
}

}  // namespace
}  // namespace ex9000::sim
