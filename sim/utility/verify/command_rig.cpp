#include "sim/utility/verify/command_rig.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "sim/text/fail.hpp"

namespace ex9000::utility {

namespace {

constexpr int kEnds = 2'000;  // ms, after its input is closed
constexpr int kMostReadings = 100;
constexpr int kAnswers = 60'000;  // ms: a rig may wait until a capacitor is empty

struct Pipe {
  sim::FileDescriptor from;
  sim::FileDescriptor to;
};

Pipe make_pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    sim::unavailable(std::string("--rig: ") + std::strerror(errno));
  }
  return {sim::FileDescriptor(ends[0]), sim::FileDescriptor(ends[1])};
}

/// In a process group of its own: Ctrl-C must not end it before the settings are restored.
pid_t start(const std::string& command, int input, int output) {
  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawnattr_t attributes{};
  posix_spawnattr_init(&attributes);
  sigset_t defaults{};
  sigemptyset(&defaults);
  sigaddset(&defaults, SIGPIPE);  // main ignores it
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  std::string shell = "/bin/sh";
  std::string option = "-c";
  std::string text = command;
  const std::array<char*, 4> words{shell.data(), option.data(), text.data(), nullptr};
  pid_t process = -1;
  const int failed = posix_spawn(&process, shell.c_str(), &actions, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    sim::unavailable("--rig: " + shell + ": " + std::strerror(failed));
  }
  return process;
}

bool readable(int descriptor, int milliseconds) {
  pollfd wanted{descriptor, POLLIN, 0};
  int found = -1;
  do {
    found = poll(&wanted, 1, milliseconds);
  } while (found < 0 && errno == EINTR);
  return found > 0;
}

}  // namespace

CommandRig::CommandRig(std::string command) : command_(std::move(command)) {
  Pipe requests = make_pipe();
  Pipe answers = make_pipe();
  process_ = start(command_, requests.from.get(), answers.to.get());
  requests_ = std::move(requests.to);
  answers_ = std::move(answers.from);
}

CommandRig::~CommandRig() {
  requests_ = sim::FileDescriptor();
  std::array<char, 512> rest{};
  for (int i = 0; i < kMostReadings; ++i) {
    if (!readable(answers_.get(), kEnds) || ::read(answers_.get(), rest.data(), rest.size()) <= 0) {
      break;
    }
  }
  kill(-process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

void CommandRig::broken(const std::string& what) const {
  sim::unavailable("--rig: '" + command_ + "' " + what);
}

std::string CommandRig::answer_to(const std::string& request) {
  if (!received_.empty()) {
    broken("has answered more than it was asked; it must answer each request with a line");
  }
  const std::string line = request + "\n";
  if (::write(requests_.get(), line.data(), line.size()) != static_cast<ssize_t>(line.size())) {
    broken("has ended; it must answer until its input ends");
  }
  std::size_t end = 0;
  while ((end = received_.find('\n')) == std::string::npos) {
    std::array<char, 512> more{};
    if (!readable(answers_.get(), kAnswers)) {
      broken("has not answered '" + request + "' for 60 s; it must answer each request with a line");
    }
    const ssize_t size = ::read(answers_.get(), more.data(), more.size());
    if (size <= 0) {
      broken("has ended; it must answer until its input ends");
    }
    received_.append(more.data(), static_cast<std::size_t>(size));
  }
  std::string answer = received_.substr(0, end);
  received_.erase(0, end + 1);
  return answer;
}

std::string CommandRig::ask(const std::string& request) {
  const std::string answer = answer_to(request);
  const std::string ok = "ok";
  if (answer == ok || answer.rfind(ok + " ", 0) == 0) {
    return answer == ok ? "" : answer.substr(ok.size() + 1);
  }
  if (answer == "cannot") {
    throw NotVerified("the rig cannot do '" + request + "'");
  }
  if (answer.rfind("error", 0) == 0) {
    broken("reports to '" + request + "': " + answer);
  }
  broken("answers '" + request + "' with '" + answer + "'; expected ok, ok VALUE, cannot or error: TEXT");
}

}  // namespace ex9000::utility
