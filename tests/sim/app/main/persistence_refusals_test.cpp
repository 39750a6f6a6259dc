// Tests which files the program rejects as the EEPROM of a module. If the program rejects an argument, it
// must not create the file of an EEPROM.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <string>

#include "tests/sim/app/main/persistent_simulator.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/simulator_process.hpp"

namespace ex9000::system {
namespace {

namespace fs = std::filesystem;

/// Expects that the program ends with `status`, prints nothing on standard output, and changes nothing in
/// `directory`. The program must print one line on standard error, and this line must name `file`.
void expect_refused(const Arguments& modules, const std::string& file, const Directory& directory,
                    int status = 2) {
  const auto before = directory.contents();
  Arguments command{"timeout", "60", simulator_path(), "--control", "control"};
  command.insert(command.end(), modules.begin(), modules.end());
  const Finished finished = run(command, directory.path());
  EXPECT_EQ(finished.status, status) << finished.error;
  EXPECT_EQ(finished.output, "");
  EXPECT_TRUE(has(finished.error, "eeprom=: " + file + ": ")) << finished.error;
  EXPECT_EQ(std::count(finished.error.begin(), finished.error.end(), '\n'), 1) << finished.error;
  EXPECT_EQ(directory.contents(), before) << finished.error;
}

/// Expects that the program rejects the file as the EEPROM of a single module, and as the EEPROM of the
/// second of two modules. In the second case, the program must not create the file of the first module.
void expect_refused(const std::string& file, const Directory& directory, int status = 2) {
  expect_refused({"EX9042D,name=NEW,eeprom=" + file}, file, directory, status);
  expect_refused({"EX9052D@02,eeprom=beside", "EX9042D,eeprom=" + file}, file, directory, status);
}

std::string some_image() { return std::string(kImageSize, '\xFF'); }

TEST(BadFile, AFileOfTheWrongSizeIsRefused) {
  for (const std::size_t size : {0U, 100U, 8191U, 8193U}) {
    const Directory directory;
    write_file(directory / "image", std::string(size, 'x'));
    expect_refused("image", directory);
  }
}

TEST(BadFile, AFileWithoutWritePermissionIsRefused) {
  const Directory directory;
  write_file(directory / "image", some_image());
  fs::permissions(directory / "image", fs::perms(0444));
  expect_refused("image", directory);
}

TEST(BadFile, DirectoriesPipesAndDevicesAreRefusedWithoutBlocking) {
  const Directory directory;
  fs::create_directory(directory / "image");
  ASSERT_EQ(mkfifo((directory / "fifo").c_str(), 0644), 0);
  for (const char* file : {"image", "fifo", "/dev/null", "/dev/full"}) {
    expect_refused(file, directory);
  }
}

TEST(BadFile, AFileThatCannotBeCreatedIsRefusedAndNoOtherFileIsCreated) {
  const Directory directory;
  fs::create_symlink("missing/image", directory / "dangling");
  for (const char* file : {"missing/image", "dangling", "/proc/image"}) {
    expect_refused(file, directory);
  }
}

TEST(BadFile, AFileInUseByAnotherProcessIsRefusedUnderAnyName) {
  const Directory directory;
  write_file(directory / "image", some_image());
  fs::create_symlink("image", directory / "symbolic");
  fs::create_hard_link(directory / "image", directory / "hard");
  Simulator simulator({"EX9042D" + image_in(directory)});
  for (const char* file : {"image", "symbolic", "hard", "./image"}) {
    expect_refused(file, directory, 1);
  }
  EXPECT_EQ(simulator.ask("~01ONEW"), "!01");
  simulator.process().end(SIGKILL);
  EXPECT_EQ(Simulator({"EX9042D" + image_in(directory)}).ask("$01M"), "!01NEW");
}

TEST(BadFile, TwoNamesOfOneFileForTwoModulesAreRefused) {
  const Directory directory;
  write_file(directory / "image", some_image());
  fs::create_symlink("image", directory / "symbolic");
  fs::create_hard_link(directory / "image", directory / "hard");
  // The program compares the paths, not the inodes: a file with another name is in use.
  const std::pair<const char*, int> cases[] = {{"image", 2}, {"symbolic", 1}, {"./image", 2}, {"hard", 1}};
  for (const auto& [file, status] : cases) {
    expect_refused({"EX9042D,eeprom=image", std::string("EX9052D@02,eeprom=") + file}, file, directory,
                   status);
  }
}

TEST(BadFile, TwoNamesOfOneMissingFileAreRefusedAndNoFileIsCreated) {
  const Directory directory;
  fs::create_directory(directory / "place");
  fs::create_directory_symlink("place", directory / "elsewhere");
  expect_refused({"EX9042D,eeprom=image", "EX9052D@02,eeprom=./image"}, "./image", directory);
  expect_refused({"EX9042D,eeprom=place/image", "EX9052D@02,eeprom=elsewhere/image"}, "elsewhere/image",
                 directory);
  const Finished finished =
      run({simulator_path(), "EX9042D,eeprom=image", "EX9052D@02,eeprom=./image"}, directory.path());
  EXPECT_TRUE(has(finished.error, "eeprom=: ./image: is already used")) << finished.error;
}

TEST(BadFile, NoFileIsCreatedIfAnotherArgumentIsRefused) {
  const Directory directory;
  write_file(directory / "taken", "precious");
  const auto before = directory.contents();
  const std::pair<Arguments, int> cases[] = {{{"--control", "taken"}, 2},
                                             {{"--port", "pty:taken"}, 2},
                                             {{"--port", "pty:missing/tty"}, 2},
                                             {{"--port", "tcp:256.0.0.1:5020"}, 2},
                                             {{"--port", "serial:missing"}, 1}};
  for (const auto& [wrong, status] : cases) {
    Arguments command{"timeout", "60", simulator_path(), "EX9042D,eeprom=image"};
    command.insert(command.end(), wrong.begin(), wrong.end());
    EXPECT_EQ(run(command, directory.path()).status, status) << wrong[0];
    EXPECT_EQ(directory.contents(), before) << wrong[0];
  }
}

}  // namespace
}  // namespace ex9000::system
