// Combines the bytes on the wires into frames, for logs, captures and the panel.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "sim/line_monitor/frames/frame_meaning.hpp"
#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

/// What one station has sent, by the rules of FrameWatch.
struct Frame {
  /// Sent with wrong parity, or changed by a disturbance.
  struct Change {
    std::size_t position = 0;  ///< position among the sent bytes, from 0
    std::uint8_t sent = 0;
    Levels arrives = 0;
    LineFormat format = LineFormat::k8N1;

    /// As receivers in the sender's mode read it; nullopt: without the start bit, they do not detect it.
    [[nodiscard]] std::optional<std::uint8_t> byte() const {
      constexpr Levels kStartBit = 1;
      return (arrives & kStartBit) == 0 ? std::optional(byte_of(arrives)) : std::nullopt;
    }
    /// As they report it, if the start bit is not lost.
    [[nodiscard]] ByteStatus status() const { return status_of(arrives, format); }
  };

  std::size_t station = 0;  ///< number in the order of attachment; 0 is the master
  /// As receivers in the sender's mode get them, collided or not. A byte without its start bit is left out.
  FrameBytes bytes;
  std::vector<Change> changes;
  bool collided = false;  ///< see WireObserver::byte; true if at least one byte collided
  /// Of an arbitration: the largest time between the bytes FF of two modules in a window.
  VirtualTime skew{0};
  /// At the first byte. Receivers in the line's mode get `bytes` only if rates and parities are equal.
  SerialMode sent_in;
  SerialMode line_in;
  VirtualTime began{0};  ///< start of the first start bit
  VirtualTime ended{0};  ///< end of the last stop bit

  [[nodiscard]] Speaker speaker() const { return station == 0 ? Speaker::Master : Speaker::Module; }
};

/// Combines bytes into frames. A DCON frame ends with CR, or 5 s after its last byte: a person may type it.
/// Any other ends after 5 ms or four characters of 11 bits, whichever is longer: the master may write it in
/// pieces. A frame of the master that is not DCON also ends when another station enables its driver; one with
/// a correct CRC, before a byte after a gap of more than 1.5 characters. A frame of another station also ends
/// when that disables its driver. All end after 300 bytes at the latest. The bytes FF of an arbitration are
/// one frame of the first module that sends one; those of several modules in a window merge into one byte.
class FrameWatch final : public WireObserver {
 public:
  using Take = std::function<void(const Frame&)>;
  /// The present mode of the line.
  using Mode = std::function<SerialMode()>;

  explicit FrameWatch(Mode line_mode) : line_mode_(std::move(line_mode)) {}

  /// `take` gets each later frame when it has ended.
  void add_receiver(Take take) { takers_.push_back(std::move(take)); }

  /// When `run` must pass on a frame if no byte follows; kNever: no frame is unfinished.
  [[nodiscard]] VirtualTime next() const;
  void run(VirtualTime now);
  /// When no more bytes follow.
  void finish() { run(kNever); }

  void driver(std::size_t station, bool on, VirtualTime now) override;
  void changed(std::size_t station, Levels arrives) override;
  void byte(std::size_t station, std::uint8_t byte, SerialMode mode, bool collided, VirtualTime start,
            VirtualTime end) override;

 private:
  struct Sender {
    Frame frame;  ///< the bytes since the last frame was passed on
    std::size_t sent = 0;
    std::optional<Levels> change;  ///< change of the byte in progress
    VirtualTime frame_deadline = kNever;
  };

  Sender& sender(std::size_t station);
  void burst(std::size_t station, SerialMode mode, VirtualTime start, VirtualTime end);
  void end_arbitration();
  [[nodiscard]] bool begins_another(VirtualTime start, VirtualTime end);
  void hand_out(std::size_t station);
  void hand_out(Sender& sending, std::size_t station);

  Mode line_mode_;
  std::vector<Take> takers_;
  std::vector<Sender> senders_;
  Sender arbitration_;
  VirtualTime last_burst_{0};  ///< the beginning of the first byte in the present window
};

}  // namespace ex9000::sim
