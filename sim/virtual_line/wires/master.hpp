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

  /// Attaches itself to `wires`. `receive` is called for each byte that arrives while the driver of the
  /// master is off.
  Master(Wires& wires, SerialMode mode, Receive receive);
  Master(const Master&) = delete;
  Master& operator=(const Master&) = delete;

  /// Returns how long `bytes` bytes without gaps take at the present rate and in the present format.
  [[nodiscard]] VirtualTime takes(std::size_t bytes) const { return wire_.takes(bytes, mode_); }
  /// Adds the bytes to the end of the queue of this master. If the master is already sending, the new bytes
  /// follow without a gap, and `not_before` is ignored. Otherwise the first new byte begins now or at
  /// `not_before`, whichever is later. The driver is enabled from the first byte to the last. Does not block.
  /// The bytes at the positions `damaged`, counted from 0, have wrong parity if the format has a parity bit.
  /// `sender`: see `drop`.
  void send(const std::uint8_t* bytes, std::size_t size, VirtualTime not_before = VirtualTime(0),
            const std::vector<std::size_t>& damaged = {}, const void* sender = nullptr);
  /// Removes the bytes of `sender` that wait for their start bit. `sender` is only compared.
  void drop(const void* sender);
  /// Returns whether bytes of this master wait or are on the wires.
  [[nodiscard]] bool sending() const { return driving_ || !waiting_.empty(); }
  /// Returns how many bytes `send` has taken so far.
  [[nodiscard]] std::uint64_t taken() const { return taken_; }
  /// Returns how many bytes wait for their start bit.
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }

  /// Sets the rate and format. The receiver uses them immediately, and the sender uses them from the next
  /// byte on.
  void set_mode(SerialMode mode);
  void set_baud(std::uint32_t baud) { set_mode({baud, mode_.format}); }
  void set_format(LineFormat format) { set_mode({mode_.baud, format}); }

  /// Sets a second function to call for the same bytes as the `receive` of the constructor. The master calls
  /// the second function first.
  void also_receive(Receive receive) { also_receive_ = std::move(receive); }

  [[nodiscard]] SerialMode mode() const { return mode_; }
  /// Sets a function to call when the rate or the format changes.
  void on_mode(std::function<void(SerialMode mode)> changed) { changed_ = std::move(changed); }

  // --- Station ---
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
