// Tests a standard stream with long texts, a full pipe, a pipe without a reader, and an error.
#include "sim/app/main/standard_stream.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <climits>
#include <csignal>
#include <stdexcept>
#include <string>

#include "sim/files_and_ports/files/file_descriptor.hpp"

namespace ex9000::sim {
namespace {

/// Both ends of a pipe. Neither end blocks.
struct Pipe {
  Pipe() {
    std::array<int, 2> ends{};
    EXPECT_EQ(pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK), 0);
    reader = FileDescriptor(ends[0]);
    writer = FileDescriptor(ends[1]);
  }

  /// Removes all bytes from the pipe and returns them.
  [[nodiscard]] std::string content() const {
    std::string text;
    std::array<char, 1000> buffer{};
    for (ssize_t size = 0; (size = read(reader.get(), buffer.data(), buffer.size())) > 0;) {
      text.append(buffer.data(), static_cast<std::size_t>(size));
    }
    return text;
  }

  FileDescriptor reader;
  FileDescriptor writer;
};

TEST(StandardStream, WritesAllOfATextThatIsLongerThanOnePiece) {
  const Pipe pipe;
  const std::string text = std::string(PIPE_BUF, 'a') + std::string(PIPE_BUF, 'b') + "c";
  EXPECT_TRUE(StandardStream(pipe.writer.get(), "the pipe").write(text));
  EXPECT_EQ(pipe.content(), text);
}

TEST(StandardStream, DiscardsAllTextsAfterItHasGivenUp) {
  const Pipe pipe;
  bool gives_up = false;
  StandardStream stream(pipe.writer.get(), "the pipe", [&gives_up] { return gives_up; });
  EXPECT_TRUE(stream.write("first"));
  gives_up = true;
  constexpr std::size_t kMoreThanAPipeHolds = 1'000'000;
  EXPECT_FALSE(stream.write(std::string(kMoreThanAPipeHolds, 'x')));
  EXPECT_EQ(pipe.content().substr(0, 6), "firstx");
  EXPECT_FALSE(stream.write("last"));
  EXPECT_EQ(pipe.content(), "");
}

TEST(StandardStream, DiscardsAllTextsAfterTheReaderHasClosedThePipe) {
  ASSERT_NE(std::signal(SIGPIPE, SIG_IGN), SIG_ERR);
  Pipe pipe;
  pipe.reader = FileDescriptor();
  StandardStream stream(pipe.writer.get(), "the pipe");
  EXPECT_FALSE(stream.write("first"));
  EXPECT_FALSE(stream.write("second"));
}

TEST(StandardStream, ReportsAnErrorOtherThanAClosedPipeOnlyOnce) {
  const FileDescriptor only_to_read(open("/dev/null", O_RDONLY | O_CLOEXEC));
  StandardStream stream(only_to_read.get(), "the stream");
  try {
    stream.write("first");
    ADD_FAILURE() << "expected an exception";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "the stream: Bad file descriptor");
  }
  EXPECT_FALSE(stream.write("second"));
}

}  // namespace
}  // namespace ex9000::sim
