// The master's end of the line: sends bytes on the wires one after the other, and receives bytes.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

class Master final : public Station {
 public:
  using Receive = std::function<void(std::uint8_t byte, ByteStatus status)>;

  /// `receive` gets each byte that arrives while the master's driver is off.
  Master(Wires& wires, SerialMode mode, Receive receive);
  Master(const Master&) = delete;
  Master& operator=(const Master&) = delete;

  /// Without gaps, in the present mode.
  [[nodiscard]] VirtualTime takes(std::size_t bytes) const { return wire_.takes(bytes, mode_); }
  /// Queues the bytes; does not block. While the master sends, they follow without a gap, whatever
  /// `not_before`; else the first begins at `not_before`, or now if that is later. The driver is on from the
  /// first to the last. `damaged`: positions of bytes with wrong parity, from 0. `sender`: see `drop`.
  void send(const std::uint8_t* bytes, std::size_t size, VirtualTime not_before = VirtualTime(0),
            const std::vector<std::size_t>& damaged = {}, const void* sender = nullptr);
  /// Removes the bytes of `sender`, which is only compared, that wait for their start bit.
  void drop(const void* sender);
  [[nodiscard]] bool sending() const { return driving_ || !waiting_.empty(); }
  /// Bytes that `send` has taken so far.
  [[nodiscard]] std::uint64_t taken() const { return taken_; }
  /// Bytes that wait for their start bit.
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }

  /// Applies to the receiver at once, to the sender from the next byte on.
  void set_mode(SerialMode mode);
  void set_baud(std::uint32_t baud) { set_mode({baud, mode_.format}); }
  void set_format(LineFormat format) { set_mode({mode_.baud, format}); }

  /// Gets the same bytes as the constructor's `receive`, and gets them first.
  void also_receive(Receive receive) { also_receive_ = std::move(receive); }

  [[nodiscard]] SerialMode mode() const { return mode_; }
  void on_mode(std::function<void(SerialMode mode)> changed) { changed_ = std::move(changed); }

  void run() override;
  std::optional<Character> next_byte() override;
  void receive(std::uint8_t byte, ByteStatus status) override;

 private:
  struct Waiting {
    std::uint8_t byte;
    bool damaged;
    const void* sender;
  };

  VirtualClock& clock_;
  WireEnd& wire_;
  SerialMode mode_;
  Receive receive_;
  Receive also_receive_;
  std::function<void(SerialMode mode)> changed_;
  std::deque<Waiting> waiting_;
  std::uint64_t taken_ = 0;
  bool driving_ = false;
};

}  // namespace ex9000::sim
