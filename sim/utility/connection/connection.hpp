// A master's end of a line.
#pragma once

#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "hal/serial_mode.hpp"

namespace boost::asio {
class io_context;
}

namespace ex9000::utility {

using Time = std::chrono::nanoseconds;
using Data = std::vector<std::uint8_t>;

/// On a line.
inline Time time_of(std::size_t bytes, hal::SerialMode mode) {
  return Time(std::chrono::seconds(bits_of_character(mode.format))) * bytes / mode.baud;
}
/// In any format (Modbus over Serial Line V1.02, 2.5.1).
inline Time longest_character(hal::SerialMode mode) { return time_of(1, {mode.baud, LineFormat::k8E1}); }

/// The user wants the program to end.
struct Interrupted : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "stopped"; }
};

/// What a master has heard in place of a reply.
enum class Heard : std::uint8_t {
  Nothing,
  Echo,   ///< of its own request: the adapter receives what it sends
  Noise,  ///< other bytes: damage, another mode, or several modules at once
};

inline Heard heard_of(const Data& received, const Data& request) {
  return received.empty() ? Heard::Nothing : received == request ? Heard::Echo : Heard::Noise;
}

/// The functions throw std::runtime_error if the line is gone; `receive` also throws Interrupted.
class Connection {
 public:
  Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  virtual ~Connection() = default;

  /// From now on. A gateway on the network has its own mode: this changes nothing there. Throws
  /// std::invalid_argument if the port cannot have this mode.
  virtual void set_mode(hal::SerialMode mode) = 0;
  /// A pseudo-terminal carries bytes without parity and stop bits, so all formats are one there.
  [[nodiscard]] virtual bool has_formats() const { return true; }
  virtual void send(const Data& bytes) = 0;
  /// What has arrived, as soon as there is something; nothing after `patience`.
  virtual Data receive(Time patience) = 0;
  /// Since any moment.
  virtual Time now() = 0;
  /// What runs while `receive` waits; null: nothing.
  virtual boost::asio::io_context* io() { return nullptr; }

  /// Drops what arrives meanwhile.
  void pause(Time time) {
    const Time end = now() + time;
    for (Time left = time; left > Time(0); left = end - now()) {
      receive(left);
    }
  }

  /// After a reply to a request that has been repeated since `began`: it may be that to the first try and as
  /// late as this, and so may be those to the others.
  void drop_late_replies(Time began) { pause(now() - began); }
};

}  // namespace ex9000::utility
