// Fuzzes a module with bytes, pauses and other events. A judge compares it with a second description of a
// module, see tests/world.
//
// Byte 0 of the input selects the model, and byte 1 the stored settings:
//
//     bits 0-2   baud rate: 9600, 19200, 38400, 57600, 115200, 1200, 2400 or 4800
//     bit 3      checksum
//     bit 4      counters count rising edges
//     bit 5      host watchdog enabled, timeout 0.3 s; power-on value 3, safe value 4
//     bit 6      on a model with two protocols: ASCII
//     bit 7      INIT* connected to GND
//
// Each of the other bytes is a byte on the line, directly after the one before it. Exception: `\` begins one
// of the following codes. N is the value of one byte.
//
//     \\      the byte 5C
//     \c      in Modbus the CRC, in ASCII the checksum if it is enabled, of the bytes since the last pause or
//     (in ASCII) CR \s      250 ms without a byte \g N    a gap of N/64 times T3.5 \w N    N times N ms
//     without a byte \p N    the previous byte, N more times \f N    the master uses another rate (bits 0-2
//     as above) and line format (bits 6-7) \h N    the main loop hangs for N times 0.1 ms; 0: until the
//     module watchdog resets the module \0-\7   input 0 to 7 changes its level \t      the tick stops \i
//     INIT* is connected to GND, or disconnected \m      the memory stops acknowledging, or acknowledges
//     again \r      a reset \z      a power cycle
#include <algorithm>
#include <cstring>

#include "sim/app/play/modbus_frame.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/oracles/reference/dcon_check.hpp"
#include "tests/world/plant.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace ex9000::fuzz {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using world::Bytes;
using world::Step;
using world::Time;

constexpr std::size_t kHeader = 2;
constexpr std::uint8_t kEscape = '\\';
constexpr const char* kWithNumber = "gwpfh";
constexpr Time kSilence = milliseconds(250);
constexpr std::uint32_t kRates[] = {9600, 19200, 38400, 57600, 115200, 1200, 2400, 4800};

world::Setup setup_of(std::uint8_t model, unsigned flags) {
  const reference::ModelRow& row = reference::kModelRows[model % std::size(reference::kModelRows)];
  world::Member member{&row, false, reference::Module(row).stored(), 0};
  reference::Stored& stored = member.stored;
  stored.baud_code = 3 + (flags + 3) % 8;
  stored.format = (flags & 0x08U) << 3U | (flags & 0x10U) << 3U;
  if ((flags & 0x20U) != 0) {
    stored.enabled = true;
    stored.timeout = 3;
    stored.power_on = 3 & ((1U << row.outputs) - 1);
    stored.safe = 4 & ((1U << row.outputs) - 1);
  }
  stored.modbus = row.both_protocols && (flags & 0x40U) == 0;
  member.blank = stored == reference::Module(row).stored();  // factory settings come from a blank memory
  world::Setup setup;
  setup.members = {member};
  return setup;
}

/// The judge does not know rounds of a scan (extensions.md); scan_test does. Requests by serial number
/// remain.
void ask_for_no_round(std::vector<std::uint8_t>& bytes) {
  constexpr std::uint8_t kScan = 0xFD;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const bool by_number = i + 2 < bytes.size() && bytes[i + 1] == 0x46 && bytes[i + 2] == 0x08;
    if (bytes[i] == kScan && !by_number) {
      ++bytes[i];
    }
  }
}

class Life {
 public:
  Life(std::uint8_t model, std::uint8_t flags) : plant_(setup_of(model, flags)) {
    init_ = (flags & 0x80U) != 0;
    happens(world::Init{0, init_});
    happens(world::Power{0, true});
    pause(milliseconds(100));
  }

  void run(const std::uint8_t* data, const std::uint8_t* end) {
    while (data != end) {
      const std::uint8_t byte = *data++;
      if (byte != kEscape) {
        put(byte);
      } else if (data != end) {
        const std::uint8_t code = *data++;
        const bool has_number = code != 0 && std::strchr(kWithNumber, code) != nullptr;
        code_of(code, has_number && data != end ? *data++ : std::uint8_t{0});
      }
    }
  }

  /// The judge requires that the module still replies to a request, whatever has happened before.
  void end() {
    pause(kSilence);
    mode_.reset();
    if (module().runs_modbus()) {
      queued_ = {static_cast<std::uint8_t>(module().address()), 0x08, 0, 0, 1, 2};
    } else {
      put('\r');  // ends a command in progress, which can change the address
      pause(kSilence);
      const std::string name = "$" + reference::hex(module().address(), 2) + "M";
      queued_.assign(name.begin(), name.end());
    }
    frame_ = queued_;
    put_check();
    if (!module().runs_modbus()) {
      put('\r');
    }
    pause(kSilence);
  }

 private:
  [[nodiscard]] const reference::Module& module() const { return plant_.likely(0).module(); }

  void put(std::uint8_t byte) {
    queued_.push_back(byte);
    frame_.push_back(byte);
    if (byte == '\r' && !module().runs_modbus()) {
      frame_.clear();
    }
  }

  void put_check() {
    const Bytes frame = frame_;
    if (module().runs_modbus()) {
      const Bytes checked = with_crc(frame);
      std::for_each(checked.end() - 2, checked.end(), [this](std::uint8_t byte) { put(byte); });
    } else if (module().checksum()) {
      for (const char digit : reference::check_of(std::string(frame.begin(), frame.end()))) {
        put(static_cast<std::uint8_t>(digit));
      }
    }
  }

  void play(const Step& step) {
    plant_.play(step);
    require(plant_.objection().empty(), plant_.objection().c_str());
  }

  /// The event happens at the end of the bytes before it.
  void happens(const Step& step) {
    if (!queued_.empty()) {
      const hal::SerialMode mode = mode_.value_or(hal::SerialMode{module().rate(), module().format()});
      const auto bits = static_cast<unsigned>(queued_.size()) * reference::character_bits(mode.format);
      ask_for_no_round(queued_);
      play(world::Send{0, mode, std::exchange(queued_, {})});
      play(world::Wait{Time(bits * 1'000'000'000ULL / mode.baud)});
    }
    play(step);
  }

  void pause(Time time) {
    happens(world::Wait{time});
    frame_.clear();
  }

  void code_of(std::uint8_t code, unsigned number) {
    switch (code) {
      case kEscape:
        return put(kEscape);
      case 'c':
        return put_check();
      case 's':
        return pause(kSilence);
      case 'g': {
        const Time silence = module().rate() > 19200
                                 ? Time(microseconds(1750))
                                 : Time(milliseconds(38'500) / static_cast<int>(module().rate()));
        return pause(silence * number / 64);
      }
      case 'w':
        return pause(milliseconds(number * number));
      case 'p':
        for (const std::uint8_t byte = frame_.empty() ? std::uint8_t{0} : frame_.back(); number != 0;
             --number) {
          put(byte);
        }
        return;
      case 'f':
        happens(world::Wait{Time(0)});
        mode_ = hal::SerialMode{kRates[number % 8], static_cast<LineFormat>(number / 64)};
        return;
      case 'h':
        return happens(world::Hang{0, microseconds(100 * number)});
      case 't':
        return happens(world::TickStops{0});
      case 'i':
        init_ = !init_;
        return happens(world::Init{0, init_});
      case 'm':
        memory_fails_ = !memory_fails_;
        return happens(world::MemoryFails{0, memory_fails_});
      case 'r':
        return happens(world::Reset{0});
      case 'z':
        happens(world::Power{0, false});
        return happens(world::Power{0, true});
      default:
        if (code >= '0' && code <= '7') {
          levels_ ^= 1U << (code - '0');
          happens(world::Input{0, static_cast<unsigned>(code - '0'), (levels_ >> (code - '0') & 1U) != 0});
        }
    }
  }

  world::Plant plant_;
  std::optional<hal::SerialMode> mode_;  ///< empty: the module's
  Bytes queued_;                         ///< bytes to send
  Bytes frame_;                          ///< bytes since the last pause
  unsigned levels_ = 0;
  bool init_ = false;
  bool memory_fails_ = false;
};

/// Puts `\c` before each pause, CR and end of a code after at least three plain bytes, so that a changed
/// frame has a right check. Returns the new size in bytes.
std::size_t mend(std::uint8_t* data, std::size_t size, std::size_t most) {
  std::size_t plain = 0;  // consecutive plain bytes directly before `at`
  for (std::size_t at = kHeader; at < size;) {
    const bool code = data[at] == kEscape && at + 1 < size;
    const bool pause = code && std::strchr("sgw", data[at + 1]) != nullptr;
    if ((pause || data[at] == '\r') && plain >= 3 && size + 2 <= most) {
      std::memmove(data + at + 2, data + at, size - at);
      data[at] = kEscape;
      data[at + 1] = 'c';
      size += 2;
      at += 2;
    }
    plain = code || data[at] == '\r' ? 0 : plain + 1;
    at += !code ? 1 : std::strchr(kWithNumber, data[at + 1]) != nullptr ? 3 : 2;
  }
  return size;
}

}  // namespace
}  // namespace ex9000::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size >= ex9000::fuzz::kHeader) {
    ex9000::fuzz::Life life(data[0], data[1]);
    life.run(data + ex9000::fuzz::kHeader, data + size);
    life.end();
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
  const std::size_t mutated = LLVMFuzzerMutate(data, size, most);
  return seed % 4 == 0 ? ex9000::fuzz::mend(data, mutated, most) : mutated;
}
