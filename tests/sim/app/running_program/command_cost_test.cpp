// Tests that the work for a control command does not grow faster than the number of lines. Allocations
// measure the work, because their number does not depend on the speed of the machine.
#include <gtest/gtest.h>

#include <array>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/write.hpp>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "sim/app/running_program/running_program.hpp"
#include "sim/app/setup/bus_file.hpp"
#include "tests/support/directory.hpp"

namespace {

std::size_t allocations = 0;

}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) {
    return memory;
  }
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }

namespace ex9000::sim {
namespace {

/// A program with paced lines of one module each, on this thread.
class Program {
 public:
  explicit Program(std::size_t lines)
      : running_(
            io_, setup(lines), [](const std::string& /*line*/) {}, nullptr, "") {
    running_.start();
    client_.connect(directory_ / "control");
    client_.non_blocking(true);
  }
  ~Program() { running_.finish(); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Returns how many allocations the program makes from the command to its reply.
  std::size_t cost(const std::string& command) {
    reply_.clear();
    const std::size_t before = allocations;
    boost::asio::write(client_, boost::asio::buffer(command + "\n"));
    while (reply_.empty() || reply_.back() != '\n') {
      io_.run_one();
      std::array<char, 256> bytes{};
      boost::system::error_code would_block;
      reply_.append(bytes.data(), client_.read_some(boost::asio::buffer(bytes), would_block));
    }
    return allocations - before;
  }
  [[nodiscard]] const std::string& reply() const { return reply_; }

 private:
  Setup setup(std::size_t lines) {
    std::string text = R"({"control": ")" + directory_ / "control" + R"(", "lines": [)";
    for (std::size_t line = 0; line < lines; ++line) {
      text += (line == 0 ? "" : ", ") + std::string(R"({"name": "line)") + std::to_string(line) +
              R"(", "port": "tcp:0", "modules": [{"model": "EX9052D"}]})";
    }
    return parse_bus_file("bus.json", text + "]}");
  }

  system::Directory directory_;
  boost::asio::io_context io_;
  RunningProgram running_;
  boost::asio::local::stream_protocol::socket client_{io_};
  std::string reply_;
};

std::size_t cost_with(std::size_t lines) {
  Program program(lines);
  program.cost("1 led");  // the first command also accepts the client
  const std::size_t cost = program.cost("1 led");
  EXPECT_EQ(program.reply(), "ok on\n");
  return cost;
}

TEST(CommandCost, GrowsAtMostWithTheNumberOfLines) {
  const std::size_t few = cost_with(10);
  const std::size_t many = cost_with(100);
  EXPECT_LE(many, 20 * few) << few << " allocations with 10 lines, " << many << " with 100";
}

}  // namespace
}  // namespace ex9000::sim
