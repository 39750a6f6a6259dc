// A master in emulated time. It uses the baud rate and the line format of the module.
#pragma once

#include <chrono>
#include <string>

#include "tests/qemu/timed_module.hpp"

namespace ex9000::rig {

/// Returns the factory settings, but with the ASCII protocol.
inline Settings ascii(const Model& model) {
  Settings settings = Settings::factory(model);
  settings.protocol = Protocol::Ascii;
  return settings;
}

/// Waits 5 ms, discards the bytes that have arrived, and sends a request. Returns the reply, which ends when
/// the module switches its driver enable off. If the reply has not ended 250 ms after the request, returns
/// the bytes that have arrived until then; none if there is no reply. The UART of the module must be on.
inline TimedModule::Bytes reply_of(TimedModule& module, const TimedModule::Bytes& request) {
  constexpr std::chrono::milliseconds kSilence{5};  // longer than T3.5 at 9600 baud
  constexpr std::chrono::milliseconds kLongestReply{250};
  constexpr std::chrono::milliseconds kSlice{1};
  module.run_for(kSilence);
  module.hear(module.mode());
  module.send(request, module.mode());
  TimedModule::Bytes reply;
  const std::chrono::nanoseconds gives_up = module.now() + kLongestReply;
  while ((reply.empty() || module.speaks()) && module.now() < gives_up) {
    module.run_for(kSlice);
    const TimedModule::Bytes more = module.hear(module.mode());
    reply.insert(reply.end(), more.begin(), more.end());
  }
  return reply;
}

/// Sends a DCON command with a CR. Returns the reply without its CR; an empty text if there is no reply.
inline std::string ask(TimedModule& module, const std::string& command) {
  const std::string frame = command + "\r";
  const TimedModule::Bytes reply = reply_of(module, {frame.begin(), frame.end()});
  const std::string text(reply.begin(), reply.end());
  return text.substr(0, text.find('\r'));
}

/// The maximum time that a module takes to start.
inline constexpr std::chrono::milliseconds kComesUpWithin{100};

}  // namespace ex9000::rig
