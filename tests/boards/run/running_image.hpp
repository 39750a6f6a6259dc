// Starts the program boards/BOARD/run as a user does. The program runs a firmware image and connects the
// module's line to a pseudo-terminal.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/child_process.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/hang.hpp"
#include "tests/support/in_repository.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

inline const std::string kRun = in_repository(EX9000_RUN);
/// The time that a master waits for a reply, long enough for a busy machine.
inline constexpr std::chrono::seconds kMasterReplyTimeout{10};

inline std::string image_of(const std::string& model) {
  return in_repository(EX9000_IMAGES "/" + model + ".elf");
}
inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A running image of a model.
class RunningImage {
 public:
  explicit RunningImage(const std::string& model, const Arguments& options = {})
      : RunningImage(File{image_of(model)}, options) {}
  static RunningImage of_file(const std::string& image, const Arguments& options = {}) {
    return {File{image}, options};
  }

  /// Ends the program with SIGTERM. The program ends only after its emulator has ended. Both hold the lock
  /// of a memory file, so the next run can then use this file.
  ~RunningImage() {
    if (process_.pid() > 0) {
      process_.end(SIGTERM);
    }
  }
  RunningImage(const RunningImage&) = delete;
  RunningImage& operator=(const RunningImage&) = delete;

  /// Returns the first line of the program's output, which is the path of the terminal.
  [[nodiscard]] std::string tty() const { return process_.output().substr(0, process_.output().find('\n')); }
  ChildProcess& process() { return process_; }
  [[nodiscard]] int emulator() const {
    const std::string pid = std::to_string(process_.pid());
    std::ifstream children("/proc/" + pid + "/task/" + pid + "/children");
    int child = -1;
    children >> child;
    return child;
  }

  /// Sends a command and a CR, and returns the reply without its CR.
  [[nodiscard]] std::string ask(const std::string& command) const { return ask_behind("", command); }
  /// Works like `ask`, but first skips replies that equal `before`, because they belong to earlier requests.
  /// Skips nothing if `before` is empty.
  [[nodiscard]] std::string ask_behind(const std::string& before, const std::string& command) const {
    Terminal terminal(tty(), 9600);
    terminal.type(command + "\r");
    std::string reply = terminal.read_line(kHang);
    while (!before.empty() && reply == before + "\r") {
      reply = terminal.read_line(kHang);
    }
    return reply.substr(0, reply.find('\r'));
  }

  /// Runs mbpoll once.
  [[nodiscard]] Finished mbpoll(Arguments options, const Arguments& values = {}) const {
    options.insert(options.begin(), {"mbpoll", "-m", "rtu", "-b", "9600", "-P", "none", "-1", "-o",
                                     std::to_string(kMasterReplyTimeout.count())});
    options.push_back(tty());
    options.insert(options.end(), values.begin(), values.end());
    return system::run(options);
  }

 private:
  struct File {
    std::string path;
  };

  RunningImage(const File& image, const Arguments& options)
      : process_(words(image.path, options), directory_.path()) {
    if (!process_.wait_for("press Ctrl-C to end")) {
      throw std::runtime_error(image.path + " does not run");
    }
  }
  static Arguments words(const std::string& image, const Arguments& options) {
    Arguments words{kRun, image};
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }

  Directory directory_;
  ChildProcess process_;
};

/// Returns whether the process has ended. A process has also ended if it is a zombie, which waits until its
/// parent reads the exit status.
inline bool has_ended(int pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/stat");
  std::string number;
  std::string name;
  std::string state;
  status >> number >> name >> state;
  return !status || state == "Z";
}

/// Waits up to kHang for the end of a process, which need not be a child of the test program. Returns whether
/// the process has ended.
inline bool ends(int pid) {
  const int process = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  pollfd over{process, POLLIN, 0};
  const bool ended = process < 0 || poll(&over, 1, std::chrono::milliseconds(kHang).count()) == 1;
  close(process);
  return ended && has_ended(pid);
}

/// Repeats `command` until `reply` arrives, as a master does, because a module receives nothing while it
/// sends or hangs. Returns false if `reply` does not arrive within about kHang.
inline bool gets(const RunningImage& image, const std::string& command, const std::string& reply) {
  constexpr std::chrono::seconds kRepeats{1};  // a slow reply only causes more requests
  Terminal terminal(image.tty(), 9600);
  const auto gives_up = std::chrono::steady_clock::now() + kHang;
  while (std::chrono::steady_clock::now() < gives_up) {
    terminal.type(command + "\r");
    for (std::string line = terminal.read_line(kRepeats); !line.empty();
         line = terminal.read_line(kRepeats)) {
      if (line == reply + "\r") {
        return true;
      }
    }
  }
  return false;
}

/// Starts the program in `directory` with `arguments`. Expects the exit status `status`, one line of error
/// output that contains all `words`, no other output, and no change in `directory`.
inline void expect_refusal(const Directory& directory, const Arguments& arguments, const Arguments& words,
                           int status = 2) {
  const auto before = directory.contents();
  Arguments command{"/usr/bin/python3", kRun};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const Finished finished = system::run(command, directory.path());
  EXPECT_EQ(finished.status, status) << finished.error;
  EXPECT_EQ(finished.output, "");
  EXPECT_EQ(finished.error.find('\n'), finished.error.size() - 1) << finished.error;
  for (const std::string& word : words) {
    EXPECT_TRUE(has(finished.error, word)) << word << "\n" << finished.error;
  }
  EXPECT_EQ(directory.contents(), before);
}

}  // namespace ex9000::system
