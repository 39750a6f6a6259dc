#include "tests/qemu/qmp_client.hpp"

#include <stdexcept>
#include <utility>

namespace ex9000::rig {

namespace {

bool has(const std::string& line, const std::string& key) {
  return line.find("\"" + key + "\"") != std::string::npos;
}

}  // namespace

QmpClient::QmpClient(UnixSocket socket) : socket_(std::move(socket)) {
  socket_.receive_line();
  execute("qmp_capabilities", "return");
}

void QmpClient::execute(const std::string& command, const std::string& event, const std::string& arguments) {
  socket_.send(R"({"execute": ")" + command + R"(", "arguments": )" + arguments + "}\n");
  bool accepted = false;
  bool done = false;
  while (!accepted || !done) {
    const std::string line = socket_.receive_line();
    if (has(line, "error")) {
      throw std::runtime_error("QMP command " + command + ": the emulator replies " + line +
                               "; expected no error");
    }
    accepted = accepted || has(line, "return");
    done = done || has(line, event);
  }
}

void QmpClient::wait_for(const std::string& event) {
  while (!has(socket_.receive_line(), event)) {
  }
}

}  // namespace ex9000::rig
