// A module, a master, and the commands of the control socket.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "sim/front_ends/control_socket/control.hpp"
#include "sim/text/values.hpp"
#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {

inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Checks the form that every reply must have, and returns the text of `reply`.
inline std::string checked(const Control::Reply& reply) {
  const std::string& text = reply.text;
  EXPECT_TRUE(text == "ok" || text.rfind("ok ", 0) == 0 || text.rfind("error: ", 0) == 0) << text;
  EXPECT_EQ(text.find_first_of("\r\n"), std::string::npos) << text;
  EXPECT_NE(text.back(), ' ') << text;
  return text;
}

/// A module, a master, and the commands of the control socket.
class ControlBench : public ModuleBench {
 public:
  explicit ControlBench(const std::string& spec) : ModuleBench(spec), control_({{"", line()}}) {}

  std::string tell(const std::string& command) {
    const Control::Reply reply = control_.carry_out(command);
    EXPECT_FALSE(reply.quit) << command;
    return checked(reply);
  }

  /// Carries out a command whose reply has the form `ok HEX`, and returns the number in the reply.
  unsigned number(const std::string& command) {
    const std::string reply = tell(command);
    EXPECT_EQ(reply.rfind("ok ", 0), 0U) << reply;
    EXPECT_EQ(reply.find_first_not_of("0123456789ABCDEFabcdef", 3), std::string::npos) << reply;
    return static_cast<unsigned>(std::stoul(reply.substr(3), nullptr, 16));
  }

  bool status_has(const std::string& part) { return has(tell("1 status"), part); }

  /// Returns a text with the status, the inputs, the outputs and the LED of the module, and with the faults
  /// and the mode of the line. If the module has power, the text also contains the reset status, the state of
  /// INIT* and the counters.
  std::string snapshot() {
    const hal::SerialMode mode = line().master().mode();
    std::string text = tell("1 status") + tell("1 inputs") + tell("1 outputs") + tell("1 led") +
                       tell("faults") + std::to_string(mode.baud) + line_format_text(mode.format);
    if (module().powered()) {
      const State& state = module().module().state();
      text += " reset status " + std::to_string(static_cast<int>(state.reset_status)) + " init " +
              std::to_string(static_cast<int>(state.init_asserted));
      for (unsigned channel = 0; channel < module().model().inputs; ++channel) {
        text += " " + std::to_string(state.inputs.counter(channel));
      }
    }
    return text;
  }

  /// Expects that the command does not end the program and is rejected, and that `snapshot` returns the same
  /// text before the command and 20 ms after it.
  void expect_refused(const std::string& command) {
    run(std::chrono::milliseconds(20));
    const std::string before = snapshot();
    EXPECT_EQ(tell(command).rfind("error: ", 0), 0U) << command;
    run(std::chrono::milliseconds(20));
    EXPECT_EQ(snapshot(), before) << command;
  }

 private:
  Control control_;
};

}  // namespace ex9000::sim
