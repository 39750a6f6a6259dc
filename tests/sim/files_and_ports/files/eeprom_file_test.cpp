// Tests the file of a module's EEPROM: which files are opened, created and refused, and how they are written
// and locked.
#include "sim/files_and_ports/files/eeprom_file.hpp"

#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
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

/// Returns an image in which no two pages of 32 bytes are equal.
Image some_image() {
  Image image(kImageSize);
  for (std::size_t i = 0; i < image.size(); ++i) {
    image[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
  }
  return image;
}

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

std::string refusal_of(const std::string& path) {
  try {
    return refusal([&path] { const EepromFile file(path); });
  } catch (const std::runtime_error& in_use) {
    return in_use.what();
  }
}

/// Expects a one-line message that begins with the path of the file.
void expect_refused(const std::string& refusal, const std::string& path) {
  EXPECT_EQ(refusal.find(path + ": "), 0U) << refusal;
  EXPECT_EQ(std::count(refusal.begin(), refusal.end(), '\n'), 0) << refusal;
}

bool write_byte(const EepromFile& file, std::uint16_t address, std::uint8_t byte) {
  return file.write(address, {&byte, 1});
}

TEST(EepromFile, AMissingFileIsNotFoundAndNotCreated) {
  const Directory directory;
  const EepromFile file(directory / "a");
  EXPECT_FALSE(file.found());
  EXPECT_EQ(file.path(), directory / "a");
  EXPECT_TRUE(directory.contents().empty());
}

TEST(EepromFile, CreateWritesOnlyTheImage) {
  const Directory directory;
  EepromFile file(directory / "a");
  file.create(some_image());
  EXPECT_EQ(bytes_of_file(directory / "a"), text_of(some_image()));
  EXPECT_EQ(directory.contents().size(), 1U);
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

TEST(EepromFile, AnExistingFileIsReadByteForByteAndNotChanged) {
  const Directory directory;
  write_file(directory / "a", text_of(some_image()));
  const auto before = directory.contents();
  {
    const EepromFile file(directory / "a");
    ASSERT_TRUE(file.found());
    EXPECT_EQ(*file.found(), some_image());
  }
  EXPECT_EQ(directory.contents(), before);
}

TEST(EepromFile, AWriteChangesOnlyTheByteAtTheGivenAddress) {
  const Directory directory;
  Image image = some_image();
  EepromFile made(directory / "a");
  made.create(image);
  for (const std::uint16_t address : std::vector<std::uint16_t>{0, 31, 32, 4096, 8191}) {
    image[address] ^= 0xFFU;
    EXPECT_TRUE(write_byte(made, address, image[address]));
    EXPECT_EQ(bytes_of_file(directory / "a"), text_of(image)) << address;
  }
}

TEST(EepromFile, WritesToNewAndExistingFilesPersist) {
  const Directory directory;
  Image image = some_image();
  {
    EepromFile made(directory / "a");
    made.create(image);
    image[100] = 1;
    EXPECT_TRUE(write_byte(made, 100, 1));
  }
  {
    const EepromFile found(directory / "a");
    ASSERT_EQ(found.found().value_or(Image()), image);
    image[200] = 2;
    EXPECT_TRUE(write_byte(found, 200, 2));
  }
  EXPECT_EQ(EepromFile(directory / "a").found().value_or(Image()), image);
}

TEST(EepromFile, NothingCanBeWrittenBeforeTheFileIsCreated) {
  const Directory directory;
  const EepromFile file(directory / "a");
  EXPECT_FALSE(write_byte(file, 0, 1));
  EXPECT_TRUE(directory.contents().empty());
}

TEST(EepromFile, AFileOfTheWrongSizeIsRefusedAndNotChanged) {
  for (const std::size_t size : {0U, 1U, 100U, 8191U, 8193U, 65536U}) {
    const Directory directory;
    write_file(directory / "a", std::string(size, 'x'));
    const auto before = directory.contents();
    const std::string refused = refusal_of(directory / "a");
    expect_refused(refused, directory / "a");
    EXPECT_NE(refused.find("has " + std::to_string(size) + " bytes"), std::string::npos) << refused;
    EXPECT_EQ(directory.contents(), before) << size;
  }
}

TEST(EepromFile, AFileWithoutWritePermissionIsRefused) {
  const Directory directory;
  write_file(directory / "a", text_of(some_image()));
  for (const fs::perms mode : {fs::perms(0444), fs::perms(0400), fs::perms(0)}) {
    fs::permissions(directory / "a", mode);
    expect_refused(refusal_of(directory / "a"), directory / "a");
  }
  fs::permissions(directory / "a", fs::perms(0644));
  EXPECT_EQ(refusal_of(directory / "a"), "");
}

TEST(EepromFile, DirectoriesPipesAndDevicesAreRefusedWithoutBlocking) {
  const Directory directory;
  fs::create_directory(directory / "directory");
  ASSERT_EQ(mkfifo((directory / "fifo").c_str(), 0644), 0);
  const auto before = directory.contents();
  for (const std::string& path : {directory / "directory", directory / "fifo", std::string("/dev/null"),
                                  std::string("/dev/zero"), std::string("/dev/full")}) {
    expect_refused(refusal_of(path), path);
  }
  EXPECT_EQ(directory.contents(), before);
}

TEST(EepromFile, AMissingFileIsReadAsNoImageAndAPathThroughAFileIsRefused) {
  const Directory directory;
  write_file(directory / "a", text_of(some_image()));
  EXPECT_TRUE(read_eeprom_file(directory / "a"));
  EXPECT_FALSE(read_eeprom_file(directory / "missing"));
  const std::string through_a_file = directory / "a/b";
  expect_refused(refusal([&] { read_eeprom_file(through_a_file); }), through_a_file);
}

TEST(EepromFile, APathThatCannotBeCreatedIsRefusedAndNoFileRemains) {
  const Directory directory;
  fs::create_symlink(directory / "nowhere", directory / "dangling");
  const auto before = directory.contents();
  for (const std::string& path : {directory / "missing/a", directory / "dangling", std::string("/proc/a")}) {
    EepromFile file(path);
    expect_refused(refusal([&file] { file.create(some_image()); }), path);
    EXPECT_EQ(directory.contents(), before) << path;
  }
}

TEST(EepromFile, AFileThatAnotherProgramHasCreatedIsNotReplaced) {
  const Directory directory;
  EepromFile file(directory / "a");
  write_file(directory / "a", "precious");
  const auto before = directory.contents();
  expect_refused(refusal([&file] { file.create(some_image()); }), directory / "a");
  EXPECT_EQ(directory.contents(), before);
}

TEST(EepromFile, AFileInUseIsRefusedUnderEachOfItsNamesUntilItIsReleased) {
  const Directory directory;
  write_file(directory / "a", text_of(some_image()));
  fs::create_symlink(directory / "a", directory / "symbolic");
  fs::create_hard_link(directory / "a", directory / "hard");
  const std::vector<std::string> names{directory / "a", directory / "symbolic", directory / "hard",
                                       directory / "./a"};
  for (const std::string& first : names) {
    std::optional<EepromFile> user;
    user.emplace(first);
    for (const std::string& second : names) {
      const std::string refused = refusal_of(second);
      expect_refused(refused, second);
      EXPECT_NE(refused.find("in use"), std::string::npos) << refused;
    }
    user.reset();
    for (const std::string& second : names) {
      EXPECT_EQ(refusal_of(second), "");
    }
  }
}

TEST(EepromFile, ANewlyCreatedFileIsInUse) {
  const Directory directory;
  EepromFile file(directory / "a");
  file.create(some_image());
  EXPECT_NE(refusal_of(directory / "a").find("in use"), std::string::npos);
}

TEST(EepromFile, AFileInUseIsLockedForOtherProcessesUntilItIsReleased) {
  const Directory directory;
  write_file(directory / "a", text_of(some_image()));
  const auto child_status = [&directory] {
    const pid_t child = fork();
    if (child == 0) {
      _exit(refusal_of(directory / "a").empty() ? 0 : 1);
    }
    int raw = 0;
    waitpid(child, &raw, 0);
    return WEXITSTATUS(raw);
  };
  {
    const EepromFile file(directory / "a");
    EXPECT_EQ(child_status(), 1);
  }
  EXPECT_EQ(child_status(), 0);
}

TEST(EepromFile, AnIncompleteWriteDuringCreationLeavesNoFile) {
  const Directory directory;
  EepromFile file(directory / "a");
  {
    const FileSizeLimit limit(kImageSize - 1);
    expect_refused(refusal([&file] { file.create(some_image()); }), directory / "a");
  }
  EXPECT_TRUE(directory.contents().empty());
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
