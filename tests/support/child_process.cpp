#include "tests/support/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "tests/support/hang.hpp"

namespace ex9000::system {

namespace {

struct Pipe {
  int read_end = -1;
  int write_end = -1;
};

Pipe make_pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("cannot create a pipe");
  }
  return {ends[0], ends[1]};
}

/// Starts a command. Its standard output goes to the file descriptor `out`, and its standard error to
/// `error`. If `error` is negative, the command inherits standard error. Returns the process id. Uses
/// posix_spawn instead of fork, because a test can have several threads.
int spawn(const std::vector<std::string>& command, const std::string& directory, int out, int error) {
  std::vector<char*> words;
  for (const std::string& word : command) {
    words.push_back(const_cast<char*>(word.c_str()));
  }
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
  if (error >= 0) {
    posix_spawn_file_actions_adddup2(&actions, error, STDERR_FILENO);
  }
  posix_spawn_file_actions_addchdir_np(&actions, directory.c_str());
  int pid = -1;
  const int failed = posix_spawnp(&pid, words[0], &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    throw std::runtime_error(command[0] + ": " + std::strerror(failed));
  }
  return pid;
}

int status_of(int raw) { return WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw); }

bool append_from(int fd, std::string& text) {
  std::array<char, 4096> buffer{};
  const ssize_t size = read(fd, buffer.data(), buffer.size());
  if (size <= 0) {
    return false;
  }
  text.append(buffer.data(), static_cast<std::size_t>(size));
  return true;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, const std::string& directory,
                           Errors errors) {
  const Pipe out = make_pipe();
  pid_ = spawn(command, directory, out.write_end, errors == Errors::WithOutput ? out.write_end : -1);
  close(out.write_end);
  out_ = out.read_end;
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    end(SIGKILL);
  }
  close(out_);
}

bool ChildProcess::read_more() {
  pollfd ready{out_, POLLIN, 0};
  const int result = poll(&ready, 1, kHangMilliseconds);
  if (result == 0) {
    kill(pid_, SIGKILL);  // otherwise, `wait` does not return
  }
  return result == 1 && append_from(out_, output_);
}

bool ChildProcess::wait_for(const std::string& text, unsigned times) {
  std::size_t searched = 0;
  while (times != 0) {
    const std::size_t found = output_.find(text, searched);
    if (found != std::string::npos) {
      searched = found + text.size();
      --times;
    } else if (!read_more()) {
      return false;
    }
  }
  return true;
}

int ChildProcess::end(int signal) {
  kill(pid_, signal);
  return wait();
}

int ChildProcess::wait() {
  while (read_more()) {
  }
  int raw = 0;
  waitpid(pid_, &raw, 0);
  pid_ = -1;
  return status_of(raw);
}

Finished run(const std::vector<std::string>& command, const std::string& directory) {
  const Pipe out = make_pipe();
  const Pipe error = make_pipe();
  const int pid = spawn(command, directory, out.write_end, error.write_end);
  close(out.write_end);
  close(error.write_end);
  Finished finished{};
  std::array<pollfd, 2> ready{{{out.read_end, POLLIN, 0}, {error.read_end, POLLIN, 0}}};
  while (ready[0].fd >= 0 || ready[1].fd >= 0) {
    if (poll(ready.data(), ready.size(), kHangMilliseconds) <= 0) {
      kill(pid, SIGKILL);
      finished.error += "killed, because it has printed nothing for 60 s";
      break;  // its children may keep the pipes open
    }
    if (ready[0].revents != 0 && !append_from(out.read_end, finished.output)) {
      ready[0].fd = -1;
    }
    if (ready[1].revents != 0 && !append_from(error.read_end, finished.error)) {
      ready[1].fd = -1;
    }
  }
  close(out.read_end);
  close(error.read_end);
  int raw = 0;
  waitpid(pid, &raw, 0);
  finished.status = status_of(raw);
  return finished;
}

}  // namespace ex9000::system
