// Prints the bus, a line a frame: time, direction, bytes, meaning.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/bus.hpp"
#include "sim/meaning.hpp"

namespace ex9000::sim {

/// Groups bytes to frames: what one driver sends until it goes off, and where a person types, until CR.
class BusLog final : public BusObserver {
 public:
  using Print = std::function<void(const std::string& line)>;

  /// `speakers`: what each station is called, the master first. Others may speak too, as somebody else.
  BusLog(std::vector<std::string> speakers, Print print);

  void driver(std::size_t station, bool on, VirtualTime now) override;
  void byte(std::size_t station, std::uint8_t byte, std::uint32_t baud, bool collided, VirtualTime start,
            VirtualTime end) override;

  /// When an unfinished frame is to be printed all the same; kNever: there is none.
  [[nodiscard]] VirtualTime next() const;
  /// Prints what is due at `now`.
  void run(VirtualTime now);
  /// A line of its own with the time before it.
  void note(VirtualTime now, const std::string& text);

 private:
  /// What a station has sent since the last line.
  struct Frame {
    FrameBytes bytes;
    bool collided = false;
    VirtualTime began{0};
    VirtualTime prints = kNever;
  };

  Frame& frame_of(std::size_t station);
  void print(std::size_t station);

  std::vector<std::string> speakers_;
  Print print_;
  std::vector<Frame> frames_;
};

}  // namespace ex9000::sim
