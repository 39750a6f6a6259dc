#include "tests/rp2040/emulator_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "tests/support/hang.hpp"

namespace ex9000::pico {

namespace {

constexpr const char* kModules = "NODE_PATH=build/rp2040js/node_modules";
constexpr const char* kProgram = "tests/rp2040/emulator.js";

/// Returns the environment of the emulator: the environment of this process, but with NODE_PATH set to the
/// folder that contains the npm package rp2040js.
std::vector<char*> environment() {
  std::vector<char*> variables;
  for (char** each = environ; *each != nullptr; ++each) {
    if (std::strncmp(*each, "NODE_PATH=", 10) != 0) {
      variables.push_back(*each);
    }
  }
  variables.push_back(const_cast<char*>(kModules));
  variables.push_back(nullptr);
  return variables;
}

int spawn(int end) {
  std::array<char*, 3> words{const_cast<char*>("node"), const_cast<char*>(kProgram), nullptr};
  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, end, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, end, STDOUT_FILENO);
  int pid = -1;
  const int failed = posix_spawnp(&pid, words[0], &actions, nullptr, words.data(), environment().data());
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    throw std::runtime_error(std::string("node: cannot start: ") + std::strerror(failed) +
                             "; expected an installed Node.js");
  }
  return pid;
}

}  // namespace

EmulatorProcess::EmulatorProcess() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::runtime_error("emulator: cannot create its sockets; expected a socket pair");
  }
  pid_ = spawn(ends[1]);
  close(ends[1]);
  socket_ = ends[0];
}

EmulatorProcess::~EmulatorProcess() {
  close(socket_);
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

std::string EmulatorProcess::execute(const std::string& command) {
  const std::string line = command + "\n";
  for (std::size_t sent = 0; sent < line.size();) {
    const ssize_t size = ::send(socket_, line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
    if (size <= 0) {
      throw std::runtime_error("emulator: it has ended; expected it to take the command");
    }
    sent += static_cast<std::size_t>(size);
  }
  const std::string reply = read_line();
  if (reply.rfind("ok ", 0) != 0) {
    throw std::runtime_error(reply + " (" + command.substr(0, 80) + ")");
  }
  return reply.substr(3);
}

std::string EmulatorProcess::read_line() {
  std::size_t end = unread_.find('\n');
  while (end == std::string::npos) {
    std::array<char, 4096> buffer{};
    pollfd ready{socket_, POLLIN, 0};
    const ssize_t size =
        poll(&ready, 1, kHangMilliseconds) == 1 ? read(socket_, buffer.data(), buffer.size()) : 0;
    if (size <= 0) {
      throw std::runtime_error("emulator: it has ended or sent nothing for 60 s; expected a reply");
    }
    unread_.append(buffer.data(), static_cast<std::size_t>(size));
    end = unread_.find('\n');
  }
  std::string line = unread_.substr(0, end);
  unread_.erase(0, end + 1);
  return line;
}

}  // namespace ex9000::pico
