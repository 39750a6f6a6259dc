// A rig that is a program: it gets requests and answers them, each one line. sim/docs/verify.md has the form.
#pragma once

#include <sys/types.h>

#include <string>

#include "sim/files_and_ports/files/file_descriptor.hpp"
#include "sim/utility/verify/rig.hpp"

namespace ex9000::utility {

class CommandRig final : public Rig {
 public:
  /// Starts `command` in a shell.
  explicit CommandRig(std::string command);
  CommandRig(const CommandRig&) = delete;
  CommandRig& operator=(const CommandRig&) = delete;
  /// Closes its input, after which it should end. Kills it if it does not.
  ~CommandRig() override;

  std::string ask(const std::string& request) override;

 private:
  [[noreturn]] void broken(const std::string& what) const;
  std::string answer_to(const std::string& request);

  std::string command_;
  sim::FileDescriptor requests_;
  sim::FileDescriptor answers_;
  pid_t process_ = -1;
  std::string received_;
};

}  // namespace ex9000::utility
