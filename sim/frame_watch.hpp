// Makes frames of the bytes on the wires, for all who write down what was said.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "sim/bus.hpp"
#include "sim/meaning.hpp"

namespace ex9000::sim {

/// What one station has sent in one go.
struct Frame {
  /// A byte that a disturbance has changed.
  struct Change {
    std::size_t position;  ///< among those that were sent, from 0
    std::uint8_t sent;
    Levels arrives;

    /// None: without a start bit nobody takes it for a byte.
    [[nodiscard]] std::optional<std::uint8_t> byte() const;
    /// Good: with a stop bit.
    [[nodiscard]] ByteStatus status() const;
  };

  std::size_t station = 0;  ///< in the order of attaching; 0 is the master
  /// As whoever listens at the sender's rate gets them, but for collisions: those of a collided frame are as
  /// they were sent. What a receiver makes of the rest of a byte whose start bit is gone is not told.
  FrameBytes bytes;
  std::vector<Change> changes;
  bool collided = false;  ///< another was on meanwhile
  /// In baud; of the line, whose receivers get these bytes only where it is that of the sender.
  std::uint32_t sent_at = 0;
  std::uint32_t line_at = 0;
  VirtualTime began{0};  ///< first start bit
  VirtualTime ended{0};  ///< last stop bit

  [[nodiscard]] Speaker speaker() const { return station == 0 ? Speaker::Master : Speaker::Module; }
};

/// A frame is what one driver sends until it goes off; of the master, whose writes may come in pieces, what
/// comes until nothing more does, somebody answers, or a gap follows a right CRC; and where a person types,
/// all up to CR.
class FrameWatch final : public BusObserver {
 public:
  using Take = std::function<void(const Frame&)>;
  /// The line's rate at this moment, in baud.
  using Rate = std::function<std::uint32_t()>;

  explicit FrameWatch(Rate line_rate) : line_rate_(std::move(line_rate)) {}

  /// From now on `take` gets every frame when it is over.
  void tell(Take take) { takers_.push_back(std::move(take)); }

  /// When an unfinished frame is to be handed out all the same; kNever: there is none.
  [[nodiscard]] VirtualTime next() const;
  /// Hands out what is due at `now`.
  void run(VirtualTime now);
  /// Hands out whatever has not been: the end has come.
  void finish();

  // --- BusObserver ---
  void driver(std::size_t station, bool on, VirtualTime now) override;
  void changed(std::size_t station, Levels arrives) override;
  void byte(std::size_t station, std::uint8_t byte, std::uint32_t baud, bool collided, VirtualTime start,
            VirtualTime end) override;

 private:
  struct Sender {
    Frame frame;  ///< what it has sent since the last one was handed out
    std::size_t sent = 0;
    std::optional<Levels> change;  ///< of the byte that is under way
    VirtualTime patience_ends = kNever;
  };

  Sender& sender(std::size_t station);
  [[nodiscard]] bool begins_another(VirtualTime start, VirtualTime end);
  void hand_out(std::size_t station);

  Rate line_rate_;
  std::vector<Take> takers_;
  std::vector<Sender> senders_;
};

}  // namespace ex9000::sim
