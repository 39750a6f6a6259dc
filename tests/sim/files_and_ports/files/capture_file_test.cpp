// Tests the file of a capture: when the program creates or overwrites a file, when it refuses a path or
// reports an error, and how it waits for the reader of a pipe.
#include "sim/files_and_ports/files/capture_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "tests/support/directory.hpp"
#include "tests/support/file_size_limit.hpp"

namespace ex9000::sim {
namespace {

namespace fs = std::filesystem;
using system::bytes_of_file;
using system::Directory;
using system::FileSizeLimit;
using system::write_file;

/// The place in the configuration that names the file.
const std::string kPlace = "bus.json:2: capture: ";

std::vector<std::uint8_t> block(std::string_view text) { return {text.begin(), text.end()}; }

std::string refusal(const std::string& path) {
  try {
    const CaptureFile file(path, kPlace);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/// Returns the message of an error that may be over at the next start.
std::string unavailability(const std::string& path) {
  try {
    const CaptureFile file(path, kPlace);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(CaptureFile, IsUsedByOneSimulatorAtATime) {
  const Directory directory;
  std::optional<CaptureFile> first(std::in_place, directory / "a", kPlace);
  EXPECT_NE(unavailability(directory / "a").find("in use by another simulator"), std::string::npos);
  first->begin();
  first.reset();
  EXPECT_EQ(refusal(directory / "a"), "");
}

TEST(CaptureFile, RemovesABlockThatCouldNotBeWrittenCompletely) {
  const Directory directory;
  CaptureFile file(directory / "a", kPlace);
  file.begin();
  file.append(block("one"));
  {
    const FileSizeLimit limit(5);
    EXPECT_THROW(file.append(block("two")), std::runtime_error);
  }
  EXPECT_EQ(bytes_of_file(directory / "a"), "one");
  file.append(block("three"));
  EXPECT_EQ(bytes_of_file(directory / "a"), "onethree");
}

TEST(CaptureFile, APipeIsAcceptedIfItHasAReader) {
  const Directory directory;
  ASSERT_EQ(mkfifo((directory / "a").c_str(), 0600), 0);
  EXPECT_NE(unavailability(directory / "a").find("the pipe has no reader; start its reader first"),
            std::string::npos);
  const int reader = open((directory / "a").c_str(), O_RDONLY | O_NONBLOCK);
  CaptureFile file(directory / "a", kPlace);
  file.begin();
  file.append(block("one"));
  char text[4] = {};
  EXPECT_EQ(read(reader, text, sizeof text), 3);
  EXPECT_STREQ(text, "one");
  close(reader);
}

/// The reader reads only when the pipe is full or the writer has ended, so a write that does not wait for the
/// reader fails.
TEST(CaptureFile, WaitsForTheReaderOfAFullPipe) {
  const Directory directory;
  ASSERT_EQ(mkfifo((directory / "a").c_str(), 0600), 0);
  const int reader = open((directory / "a").c_str(), O_RDONLY | O_NONBLOCK);
  const int capacity = fcntl(reader, F_GETPIPE_SZ);
  std::optional<CaptureFile> file(std::in_place, directory / "a", kPlace);
  file->begin();
  const std::string text(64 * static_cast<std::size_t>(capacity), 'x');
  std::future<void> writer = std::async(std::launch::async, [&] {
    EXPECT_NO_THROW(file->append(block(text)));
    file.reset();
  });
  std::string all;
  std::string some(static_cast<std::size_t>(capacity), ' ');
  for (bool ended = false; !ended;) {
    int waiting = 0;
    do {
      ended = writer.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
      ASSERT_EQ(ioctl(reader, FIONREAD, &waiting), 0);
    } while (!ended && waiting < capacity);
    const ssize_t size = read(reader, some.data(), some.size());
    all.append(some, 0, static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  }
  EXPECT_EQ(all.size(), text.size());
  close(reader);
}

}  // namespace
}  // namespace ex9000::sim
