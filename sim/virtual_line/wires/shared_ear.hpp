// One ear for the stations that only listen.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "firmware/line/dcon_assembler.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/line/rtu_assembler.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/line/verdict.hpp"
#include "firmware/settings/settings.hpp"
#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

using hal::doubles::kNever;
using hal::doubles::VirtualClock;
using hal::doubles::VirtualTime;

/// How a module makes frames of bytes. Modules that differ only in the address can share an ear.
struct Hearing {
  Protocol protocol = Protocol::Ascii;
  bool checksum = false;
  std::uint8_t baud_code = 0;
  std::uint8_t address = 0;
  LineTiming timing;  ///< depends on `baud_code`
};

/// What a member has missed.
struct Heard {
  /// In `frame`, which holds the bytes of the open frame: here its silence timer has expired.
  static constexpr std::uint16_t kSilence = 0x100;

  using Verdicts = std::array<std::uint32_t, static_cast<std::size_t>(Verdict::Overrun) + 1>;

  Verdicts verdicts{};  ///< number of frames for each Verdict
  std::vector<std::uint16_t> frame;
  VirtualTime silence_ends = kNever;  ///< when the silence timer expires
};

/// Assembles frames with the firmware's own assemblers, for members that differ only in their address. A
/// frame that concerns none is only counted: it would leave them in the ear's state. Before any other frame
/// is judged, those it concerns leave, catch up, and hear its end themselves.
class SharedEar {
 public:
  /// For a member that a frame concerns, and from `dissolve`; must call `remove`.
  using Leave = std::function<void(std::size_t station)>;

  SharedEar(const VirtualClock& clock, const Hearing& hearing, Leave leave);

  [[nodiscard]] bool hears_like(const Hearing& hearing) const;
  /// No frame is open, so that a station can join.
  [[nodiscard]] bool at_rest() const { return heard_.frame.empty() && heard_.silence_ends == kNever; }
  /// Only while `at_rest`.
  void add(std::size_t station, std::uint8_t address);
  Heard remove(std::size_t station);
  [[nodiscard]] std::size_t members() const { return members_.size(); }
  void dissolve();

  /// A byte without an error. A station that leaves during the call must hear it itself.
  void hear(std::uint8_t byte);
  [[nodiscard]] VirtualTime silence_ends() const { return heard_.silence_ends; }
  /// At `silence_ends`.
  void end_silence();

 private:
  /// The firmware's part. It begins anew after a frame for all, which stays in the queue.
  struct Assembler {
    FrameQueue queue;
    RtuAssembler rtu;
    DconAssembler dcon;
  };

  [[nodiscard]] bool modbus() const { return hearing_.protocol == Protocol::ModbusRtu; }
  void begin_anew();
  [[nodiscard]] bool matters(std::uint8_t byte) const;
  [[nodiscard]] std::uint32_t name_of(std::uint8_t address) const;
  [[nodiscard]] std::vector<std::size_t> concerned_by(Verdict verdict) const;
  void judge(Verdict verdict);

  const VirtualClock& clock_;
  const Hearing hearing_;
  Leave leave_;
  std::optional<Assembler> assembler_;
  Heard heard_;  ///< `verdicts`: since the ear exists
  struct Member {
    std::size_t station;
    std::uint32_t name;            ///< `name_of` its address
    Heard::Verdicts counted_then;  ///< `heard_.verdicts` when it was added
  };
  std::vector<Member> members_;  ///< in any order
};

}  // namespace ex9000::sim
