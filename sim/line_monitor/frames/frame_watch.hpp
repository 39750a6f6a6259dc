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

/// Bytes that one station has sent, combined into a frame by the rules of FrameWatch.
struct Frame {
  /// A byte that was sent with wrong parity or that a disturbance has changed.
  struct Change {
    std::size_t position = 0;  ///< position among the sent bytes, from 0
    std::uint8_t sent = 0;
    Levels arrives = 0;
    LineFormat format = LineFormat::k8N1;

    /// Returns the byte that receivers in the sender's mode read; nullopt if the start bit is lost, because
    /// receivers then do not detect the start of the byte.
    [[nodiscard]] std::optional<std::uint8_t> byte() const {
      constexpr Levels kStartBit = 1;
      return (arrives & kStartBit) == 0 ? std::optional(byte_of(arrives)) : std::nullopt;
    }
    /// Returns the status that receivers in the sender's mode report if the start bit is not lost.
    [[nodiscard]] ByteStatus status() const { return status_of(arrives, format); }
  };

  std::size_t station = 0;  ///< number in the order of attachment; 0 is the master
  /// The bytes as a receiver in the sender's mode gets them. A collision does not change them here. If a
  /// start bit is lost, the data that a receiver reads from the rest of the byte is not included.
  FrameBytes bytes;
  std::vector<Change> changes;
  bool collided = false;  ///< see WireObserver::byte; true if at least one byte collided
  /// The modes of the sender and of the line at the first byte. Receivers in the line's mode get `bytes`
  /// only if the rates and the parities of both modes are equal. A change of a mode during the frame does not
  /// change these members.
  SerialMode sent_in;
  SerialMode line_in;
  VirtualTime began{0};  ///< start of the first start bit
  VirtualTime ended{0};  ///< end of the last stop bit

  [[nodiscard]] Speaker speaker() const { return station == 0 ? Speaker::Master : Speaker::Module; }
};

/// Combines bytes into frames by these rules. A DCON frame ends with CR, or when no byte follows for 5 s,
/// because a person may type the frame. Any other frame ends when no byte follows for 5 ms or for the time of
/// four characters of 11 bits, whichever is longer, because the master may write the frame in pieces. A frame
/// of the master that is not DCON also ends when another station enables its driver. A frame of the master
/// with a correct CRC also ends if the gap before the next byte is longer than 1.5 characters. A frame of
/// another station also ends when this station disables its driver. Every frame ends after 300 bytes at the
/// latest.
class FrameWatch final : public WireObserver {
 public:
  using Take = std::function<void(const Frame&)>;
  /// Returns the present mode of the line.
  using Mode = std::function<SerialMode()>;

  explicit FrameWatch(Mode line_mode) : line_mode_(std::move(line_mode)) {}

  /// Adds a receiver. FrameWatch calls `take` with each later frame when the frame has ended.
  void add_receiver(Take take) { takers_.push_back(std::move(take)); }

  /// Returns the earliest time at which `run` must pass on an unfinished frame if no byte follows; kNever if
  /// no frame is unfinished.
  [[nodiscard]] VirtualTime next() const;
  /// Passes on the frames that are due at `now`.
  void run(VirtualTime now);
  /// Passes on all unfinished frames. Call this when no more bytes follow.
  void finish() { run(kNever); }

  // --- WireObserver ---
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
  [[nodiscard]] bool begins_another(VirtualTime start, VirtualTime end);
  void hand_out(std::size_t station);

  Mode line_mode_;
  std::vector<Take> takers_;
  std::vector<Sender> senders_;
};

}  // namespace ex9000::sim
