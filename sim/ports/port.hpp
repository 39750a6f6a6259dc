// A way for a real master's bytes to the line and back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace ex9000::sim {

/// Nothing here blocks. All calls come from the one thread that runs the program's io_context, and so does
/// `Received`.
class Port {
 public:
  /// What has come in; false: no more until `resume`.
  using Received = std::function<bool(const std::uint8_t* bytes, std::size_t size)>;

  Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  virtual ~Port() = default;

  /// Once. `received` is called while the io_context runs.
  virtual void start(Received received) = 0;
  virtual void resume() = 0;
  /// Calls `received` for everything that has arrived by now, as if the io_context had run. Only if it may
  /// take more.
  virtual void read_waiting() {}

  /// What modules have sent. If nobody has the port open it is lost, as on wires. Returns how many bytes were
  /// dropped because somebody has it open and does not read.
  virtual std::size_t send(const std::vector<std::uint8_t>& bytes) = 0;
  /// The module that was sending has stopped.
  virtual void sent() {}

  /// The rate that a master has set here, in bits per second; nothing where it cannot, or to one that no UART
  /// has.
  [[nodiscard]] virtual std::optional<std::uint32_t> baud() const { return std::nullopt; }
  /// What comes in has already taken its time, on a real line.
  [[nodiscard]] virtual bool is_a_line() const { return false; }
};

}  // namespace ex9000::sim
