// The requests and replies of one client of Modbus TCP, without its connection.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "sim/front_ends/modbus_tcp/gateway.hpp"
#include "sim/front_ends/modbus_tcp/mbap.hpp"

namespace ex9000::sim {

/// Passes each request to the line only after the answer to the previous one, so that the clients of a line
/// take turns, and replies keep their order. The destructor drops unsent requests. Nothing blocks.
class MbapSession {
 public:
  /// `line` must outlive this object. `answered` follows each answer of `ask_on_line`; `timeout`: there.
  MbapSession(Line& line, std::function<void()> answered, VirtualTime timeout = kGatewayTimeout)
      : line_(line), answered_(std::move(answered)), timeout_(timeout) {}
  MbapSession(const MbapSession&) = delete;
  MbapSession& operator=(const MbapSession&) = delete;

  void receive(Bytes bytes);

  /// For the client. The caller removes what it has sent.
  std::vector<std::uint8_t> replies;

  /// Bytes that wait to become requests.
  [[nodiscard]] std::size_t unread() const { return reader_.size(); }
  /// By a header with a wrong protocol or length. Later bytes are ignored.
  [[nodiscard]] bool broken() const { return reader_.broken(); }
  /// All complete requests have been answered.
  [[nodiscard]] bool idle() const { return !waiting_ && !passing_on_; }

 private:
  void pass_on();
  void answer(const MbapFrame& request, const std::optional<std::vector<std::uint8_t>>& pdu);

  Line& line_;
  std::function<void()> answered_;
  VirtualTime timeout_;
  MbapReader reader_;
  bool waiting_ = false;  ///< a request has not been answered yet
  bool passing_on_ = false;
  std::shared_ptr<MbapSession*> lives_ = std::make_shared<MbapSession*>(this);
};

}  // namespace ex9000::sim
