// A DCON master at a module's own rate.
#pragma once

#include <chrono>
#include <string>

#include "tests/qemu/emulated_module.hpp"

namespace ex9000::rig {

/// Settings that make a model speak ASCII.
inline Settings ascii(const Model& model) {
  Settings settings = Settings::factory(model);
  settings.protocol = Protocol::Ascii;
  return settings;
}

/// The reply without its CR; whatever has come where none is complete within `patience`.
inline std::string ask(EmulatedModule& module, const std::string& command,
                       std::chrono::milliseconds patience = std::chrono::seconds(3)) {
  const std::string frame = command + "\r";
  module.send({frame.begin(), frame.end()});
  std::string reply;
  const auto gives_up = std::chrono::steady_clock::now() + patience;
  while (reply.find('\r') == std::string::npos && std::chrono::steady_clock::now() < gives_up) {
    const auto bytes = module.hear(gives_up - std::chrono::steady_clock::now());
    reply.append(bytes.begin(), bytes.end());
  }
  return reply.substr(0, reply.find('\r'));
}

/// Waits until the module listens, 3 s at most.
inline void wait_until_up(EmulatedModule& module) {
  const auto gives_up = std::chrono::steady_clock::now() + std::chrono::seconds(3);
  while (module.baud() == 0 && std::chrono::steady_clock::now() < gives_up) {
    module.hear(std::chrono::milliseconds(5));
  }
}

}  // namespace ex9000::rig
