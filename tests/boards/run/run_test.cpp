// These tests apply to each program boards/BOARD/run. They are built once for each board that has such a
// program.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <modbus/modbus.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <optional>

#include "tests/boards/run/running_image.hpp"
#include "tests/masters/libmodbus_master.hpp"

namespace ex9000::system {
namespace {

const std::string kMemory = EX9000_MEMORY_OPTION;
constexpr std::size_t kMemorySize = EX9000_MEMORY_SIZE;

// --- masters ---

TEST(Run, MbpollReadsBackTheCoilThatItHasWritten) {
  const RunningImage image("EX9042D-M");
  EXPECT_TRUE(has(image.mbpoll({"-a", "1", "-t", "0", "-r", "3"}, {"1"}).output, "Written 1 references."));
  EXPECT_TRUE(has(image.mbpoll({"-a", "1", "-t", "0", "-r", "1", "-c", "13"}).output,
                  "[1]: \t0\n[2]: \t0\n[3]: \t1\n[4]: \t0\n[5]: \t0\n[6]: \t0\n[7]: \t0\n[8]: \t0\n"
                  "[9]: \t0\n[10]: \t0\n[11]: \t0\n[12]: \t0\n[13]: \t0\n"));
}

TEST(Run, LibmodbusReadsBackTheCoilsThatItHasWritten) {
  const RunningImage image("EX9042D-M");
  LibmodbusMaster master(image.tty(), 9600);
  master.wait_for_replies(static_cast<unsigned>(std::chrono::milliseconds(kMasterReplyTimeout).count()));
  modbus_t* const module = master.at(1);
  const std::array<std::uint8_t, 13> written{1, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  std::array<std::uint8_t, 13> read{};
  ASSERT_EQ(modbus_write_bits(module, 0, 13, written.data()), 13) << modbus_strerror(errno);
  ASSERT_EQ(modbus_read_bits(module, 0, 13, read.data()), 13) << modbus_strerror(errno);
  EXPECT_EQ(read, written);
  EXPECT_EQ(modbus_write_bit(module, 13, 1), -1);
  EXPECT_EQ(errno, EMBXILADD);
}

TEST(Run, TheModuleRepliesToACommandThatIsTypedByHand) {
  // A busy machine makes the pauses longer, which does not affect the result.
  constexpr std::chrono::milliseconds kBetweenKeys{50};
  const RunningImage image("EX9042D");
  Terminal terminal(image.tty(), 9600);
  for (const char key : std::string("$01M")) {
    terminal.type({key});
    EXPECT_TRUE(terminal.read(kBetweenKeys).empty());
  }
  terminal.type("\r");
  EXPECT_EQ(terminal.read_line(kHang), "!019042D\r");
}

/// Observes when any process opens or closes a terminal. The kernel merges successive equal events.
class Visits {
 public:
  explicit Visits(const std::string& tty) : fd_(inotify_init1(IN_CLOEXEC)) {
    EXPECT_GE(inotify_add_watch(fd_, tty.c_str(), IN_OPEN | IN_CLOSE), 0);
  }
  ~Visits() { close(fd_); }
  Visits(const Visits&) = delete;
  Visits& operator=(const Visits&) = delete;

  /// Waits for the next event of this kind.
  void wait_for(std::uint32_t kind) {
    pollfd ready{fd_, POLLIN, 0};
    inotify_event event{};  // without a name, because the watch is on a file
    do {
      ASSERT_EQ(poll(&ready, 1, std::chrono::milliseconds(kHang).count()), 1);
      ASSERT_EQ(read(fd_, &event, sizeof event), static_cast<ssize_t>(sizeof event));
    } while ((event.mask & kind) == 0);
  }

 private:
  int fd_;
};

/// Sends a command, waits for the whole reply, and leaves it unread. Returns when the program
/// boards/BOARD/run has emptied the terminal.
void leave_reply_unread(const std::string& tty, const std::string& command, const std::string& reply) {
  std::optional<Visits> visits;
  {
    Terminal terminal(tty, 9600);
    const int fd = open(tty.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    terminal.type(command + "\r");
    const auto gives_up = std::chrono::steady_clock::now() + kHang;
    std::size_t there = 0;
    while (there < reply.size() + 1 && std::chrono::steady_clock::now() < gives_up) {
      int count = 0;
      ioctl(fd, FIONREAD, &count);
      there = static_cast<std::size_t>(count);
    }
    EXPECT_EQ(there, reply.size() + 1);
    // If the observation began earlier, it could include the time when the program empties the terminal after
    // the previous master has disconnected.
    visits.emplace(tty);
    close(fd);
  }
  // This function has closed the terminal. Then the program opens and closes it in order to empty it.
  visits->wait_for(IN_CLOSE);
  visits->wait_for(IN_OPEN);
  visits->wait_for(IN_CLOSE);
}

TEST(Run, ARequestIsExecutedAfterItsMasterHasDisconnected) {
  const RunningImage image("EX9042D");
  Terminal(image.tty(), 9600).type("@010005\r");
  EXPECT_TRUE(gets(image, "@01", ">0005"));
}

TEST(Run, TheNextMasterDoesNotReceiveAnUnreadReply) {
  const RunningImage image("EX9042D");
  for (int visit = 0; visit < 5; ++visit) {
    leave_reply_unread(image.tty(), "$01M", "!019042D");
    EXPECT_EQ(image.ask("$012"), "!01400600");
  }
}

// --- persistence ---

TEST(Run, SettingsPersistInTheMemoryFile) {
  const Directory directory;
  const Arguments options{kMemory, directory / "memory"};
  {
    RunningImage image("EX9042D-M", options);
    EXPECT_EQ(bytes_of_file(directory / "memory").size(), kMemorySize);
    // Register 0x01E4, which is 485 for mbpoll, contains the module's address.
    const Finished written = image.mbpoll({"-a", "1", "-t", "4", "-r", "485"}, {"7"});
    EXPECT_TRUE(has(written.output, "Written 1 references.")) << written.error;
    const int emulator = image.emulator();
    image.process().end(SIGKILL);
    EXPECT_TRUE(ends(emulator));  // until its end, the emulator keeps the file locked
  }
  {
    const RunningImage image("EX9042D-M", options);
    EXPECT_TRUE(has(image.mbpoll({"-a", "7", "-t", "4", "-r", "485"}).output, "[485]: \t7"));
  }
  Arguments grounded = options;
  grounded.push_back("--init");
  EXPECT_EQ(RunningImage("EX9042D-M", grounded).ask("$002"), "!07400600");
  EXPECT_EQ(bytes_of_file(directory / "memory").size(), kMemorySize);
}

TEST(Run, WithoutAFileEveryRunStartsWithFactorySettings) {
  EXPECT_EQ(RunningImage("EX9042D").ask("~01OPUMP"), "!01");
  EXPECT_EQ(RunningImage("EX9042D").ask("$01M"), "!019042D");
}

// --- end of the program ---

TEST(Run, EndsCleanlyOnASignalAndEndsTheEmulator) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Directory directory;
    RunningImage image("EX9042D", {"--link", directory / "tty"});
    EXPECT_EQ(fs::read_symlink(directory / "tty"), image.tty());
    const int emulator = image.emulator();
    ASSERT_FALSE(has_ended(emulator));
    EXPECT_EQ(image.process().end(signal), 0);
    EXPECT_TRUE(has_ended(emulator));
    EXPECT_TRUE(directory.contents().empty());
  }
}

TEST(Run, IfTheProgramIsKilledTheEmulatorEndsAndTheNextRunReplacesTheLink) {
  const Directory directory;
  const Arguments options{"--link", directory / "tty"};
  std::optional<Terminal> master;
  {
    RunningImage image("EX9042D", options);
    const int emulator = image.emulator();
    master.emplace(image.tty(),
                   9600);  // while `master` is open, no other terminal of this machine receives the same name
    image.process().end(SIGKILL);
    EXPECT_TRUE(ends(emulator));
  }
  const RunningImage next("EX9042D", options);  // replaces the link
  EXPECT_EQ(fs::read_symlink(directory / "tty"), next.tty());
}

TEST(Run, EndsWhenTheEmulatorEnds) {
  const Directory directory;
  RunningImage image("EX9042D", {"--link", directory / "tty"});
  kill(image.emulator(), SIGKILL);
  EXPECT_EQ(image.process().wait(), 1);
  EXPECT_TRUE(directory.contents().empty());
}

// --- refusals ---

TEST(Run, RefusesAFileThatIsNotAnImageForThisBoard) {
  const Directory directory;
  expect_refusal(directory, {"none.elf"},
                 {"none.elf: No such file", "cmake --build --preset " EX9000_PRESET});
  expect_refusal(directory, {"/"}, {"/: Is a directory"});
  write_file(directory / "text.elf", "no image");
  expect_refusal(directory, {"text.elf"}, {"text.elf: the file is not an ELF file for Arm"});
  expect_refusal(directory, {"/usr/bin/python3"}, {"/usr/bin/python3: the file is not an ELF file for Arm"});
  write_file(directory / "cut.elf", bytes_of_file(image_of("EX9042D")).substr(0, 40));
  expect_refusal(directory, {"cut.elf"}, {"cut.elf: the file is incomplete", "build the image again"});
  expect_refusal(directory, {in_repository(EX9000_IMAGES "/EX9042D.bin")},
                 {"EX9042D.bin: the file is not an ELF file", "MODEL.elf"});
  expect_refusal(directory, {in_repository(EX9000_OTHER_IMAGES "/EX9042D.elf")},
                 {"EX9042D.elf: the image is for another board", EX9000_PRESET});
}

TEST(Run, RefusesAMemoryFileThatItCannotUse) {
  const Directory directory;
  const std::string image = image_of("EX9042D");
  write_file(directory / "short", std::string(kMemorySize - 1, '\xFF'));
  expect_refusal(directory, {image, kMemory, "short"},
                 {kMemory + " short: the file has " + std::to_string(kMemorySize - 1) + " bytes",
                  std::to_string(kMemorySize), "remove"});
  expect_refusal(directory, {image, kMemory, "/"}, {kMemory + " /: Is a directory", "name a file"});
  expect_refusal(directory, {image, kMemory, "none/memory"}, {kMemory + " none/memory: No such file"});
  const Directory others;  // the other run may write to its file at any time
  const std::string taken = others / "taken";
  const RunningImage other("EX9042D", {kMemory, taken});
  expect_refusal(directory, {image, kMemory, taken},
                 {kMemory + " " + taken + ": another program uses this file"});
}

TEST(Run, RefusesALinkThatItCannotCreate) {
  const Directory directory;
  const std::string image = image_of("EX9042D");
  write_file(directory / "file", "somebody's");
  fs::create_symlink("file", directory / "link");
  for (const std::string path : {"file", "link", "/"}) {
    expect_refusal(directory, {image, "--link", path},
                   {"--link " + path + ": the path exists already", "remove"});
  }
  expect_refusal(directory, {image, "--link", "none/tty"}, {"--link none/tty: No such file"});
  const RunningImage other("EX9042D", {"--link", directory / "taken"});
  expect_refusal(directory, {image, "--link", "taken"}, {"--link taken: the path exists already"});
}

TEST(Run, NamesTheMissingPackage) {
  const Directory directory;
  const std::string path = getenv("PATH");
  setenv("PATH", directory.path().c_str(), 1);
  expect_refusal(directory, {image_of("EX9042D")}, {"install the package " EX9000_PACKAGE});
  setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace ex9000::system
