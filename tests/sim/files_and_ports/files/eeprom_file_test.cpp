// Tests how the file of a module's EEPROM is created and written. The tests of the program in app/main test
// which files are refused.
#include "sim/files_and_ports/files/eeprom_file.hpp"

#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/firmware/module_bench.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/file_size_limit.hpp"

namespace ex9000::sim {
namespace {

namespace fs = std::filesystem;

using system::bytes_of_file;
using system::Directory;
using system::FileSizeLimit;
using system::write_file;

constexpr std::size_t kImageSize = 8192;

using Image = std::vector<std::uint8_t>;

Image some_image() { return Image(kImageSize, 0x42); }

std::string text_of(const Image& image) { return {image.begin(), image.end()}; }

/// Returns the message of the std::invalid_argument that `act` throws; empty if `act` throws nothing.
std::string refusal(const std::function<void()>& act) {
  try {
    act();
    return "";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

/// Expects a one-line message that begins with the path of the file.
void expect_refused(const std::string& refusal, const std::string& path) {
  EXPECT_EQ(refusal.find(path + ": "), 0U) << refusal;
  EXPECT_EQ(std::count(refusal.begin(), refusal.end(), '\n'), 0) << refusal;
}

TEST(EepromFile, CreateMakesNoTemporaryFileThatCouldRemainIfTheProgramIsKilled) {
  const Directory directory;
  const int changes = inotify_init1(IN_NONBLOCK);
  ASSERT_GE(inotify_add_watch(changes, directory.path().c_str(), IN_CREATE | IN_MOVED_TO), 0);
  EepromFile file(directory / "a");
  file.create(some_image());
  alignas(inotify_event) std::array<char, 4096> events{};
  const ssize_t size = read(changes, events.data(), events.size());
  close(changes);
  inotify_event first{};
  ASSERT_GE(size, static_cast<ssize_t>(sizeof first));
  std::memcpy(&first, events.data(), sizeof first);
  EXPECT_STREQ(events.data() + sizeof first, "a");
  EXPECT_EQ(size, static_cast<ssize_t>(sizeof first + first.len)) << "more than one file was created";
}

TEST(EepromFile, ANewFileHasThePermissionsThatTheUmaskAllows) {
  const Directory directory;
  const mode_t before = umask(027);
  EepromFile file(directory / "a");
  file.create(some_image());
  umask(0);
  EepromFile file_for_all(directory / "b");
  file_for_all.create(some_image());
  umask(before);
  EXPECT_EQ(fs::status(directory / "a").permissions(), fs::perms(0640));
  EXPECT_EQ(fs::status(directory / "b").permissions(), fs::perms(0666));
}

TEST(EepromFile, AFileBeyondTheSizeLimitIsRefusedWithTheReasonAndNoFileRemains) {
  const Directory directory;
  for (const rlim_t limit : {0U, 4096U}) {
    EepromFile file(directory / "a");
    const FileSizeLimit limited(limit);
    const std::string refused = refusal([&file] { file.create(some_image()); });
    EXPECT_EQ(refused, directory / "a: cannot be created: File too large; name a path that can be written");
    EXPECT_TRUE(directory.contents().empty());
  }
}

TEST(EepromFile, NothingCanBeWrittenBeforeTheFileIsCreated) {
  const Directory directory;
  const EepromFile file(directory / "a");
  const std::uint8_t byte = 1;
  EXPECT_FALSE(file.write(0, {&byte, 1}));
  EXPECT_TRUE(directory.contents().empty());
}

TEST(EepromFile, AMissingFileIsReadAsNoImageAndAPathThroughAFileIsRefused) {
  const Directory directory;
  write_file(directory / "a", text_of(some_image()));
  EXPECT_TRUE(read_eeprom_file(directory / "a"));
  EXPECT_FALSE(read_eeprom_file(directory / "missing"));
  const std::string through_a_file = directory / "a/b";
  expect_refused(refusal([&] { read_eeprom_file(through_a_file); }), through_a_file);
}

TEST(EepromFile, AFileThatAnotherProgramHasCreatedIsNotReplaced) {
  const Directory directory;
  EepromFile file(directory / "a");
  write_file(directory / "a", "precious");
  const auto before = directory.contents();
  expect_refused(refusal([&file] { file.create(some_image()); }), directory / "a");
  EXPECT_EQ(directory.contents(), before);
}

TEST(EepromFile, AFailedWriteCausesAnErrorReplyAndKeepsTheOldSettings) {
  const Directory directory;
  {
    ModuleBench bench("EX9042D,name=OLD");
    EepromFile file(directory / "a");
    file.create(bench.module().memory().contents());
    bench.module().memory().keep(
        [&file](std::uint16_t address, ex9000::Bytes bytes) { return file.write(address, bytes); });
    {
      const FileSizeLimit limit(0);
      EXPECT_EQ(bench.ask("~01ONEW"), "?01");
    }
    EXPECT_EQ(bench.ask("$01M"), "!01OLD");
  }
  ModuleBench heir("EX9042D");
  heir.module().power(false);
  heir.module().memory().contents() = EepromFile(directory / "a").found().value_or(Image());
  heir.module().power(true);
  heir.run(std::chrono::milliseconds(100));
  EXPECT_EQ(heir.ask("$01M"), "!01OLD");
}

}  // namespace
}  // namespace ex9000::sim
