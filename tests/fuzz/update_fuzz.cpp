// Fuzzes the firmware update (extensions.md) with requests, resets and power failures in any order. Whatever
// happens, each request gets one reply, the running image stays as it is, and a reset starts a complete
// image.
//
// Byte 0 of the input: even if updates are allowed. Then codes, each a letter and the bytes that it names:
//
//     b SIZE SEED FLAGS   begin, for a new image of 37 * SIZE + 1 bytes
//     c                   begin, for the same image
//     n                   the next block
//     k NUMBER            the block with this number
//     l COUNT             as many next blocks
//     a VALUE             register 0x1013
//     r                   reads state and offset
//     x FUNCTION REGISTER SIZE BYTES
//                         function 03, 04, 06 or 10 for a register of the update, with any data
//     d PLACE BITS        inverts these bits of the data of the next begin or block, after its CRC
//     e PLACE BITS        the same, before its CRC
//     w TIME              waits for TIME * TIME ms
//     h TIME              the next request is followed by a power failure after TIME / 2 ms
//     z                   a reset
//     f                   the flash keeps nothing of what is programmed, or does again
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/line/crc16.hpp"
#include "hal/device.hpp"
#include "hal/doubles/image_slots.hpp"
#include "hal/doubles/kept_word.hpp"
#include "tests/firmware/update/messages.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/support/instant_memory.hpp"

namespace ex9000::fuzz {
namespace {

using hal::doubles::kNever;
using hal::doubles::VirtualClock;
using hal::doubles::VirtualTime;
using std::chrono::milliseconds;
using update::Buffer;
using update::State;

unsigned long long requests = 0;

/// A board whose bytes take no time.
struct Board {
  struct Line {
    Buffer sent;
    bool sends = false;
    static LineTiming timing(std::uint32_t baud, LineFormat format) { return LineTiming::at(baud, format); }
    static void open(std::uint32_t /*baud*/, LineFormat /*format*/) {}
    void send(Bytes bytes) {
      sent.insert(sent.end(), bytes.begin(), bytes.end());
      sends = true;
    }
    static void send_in_interrupt(Bytes /*bytes*/) {}
    [[nodiscard]] bool sending() const { return sends; }
    static bool low() { return false; }
  };
  struct Timer {
    const VirtualClock* clock = nullptr;
    VirtualTime due = kNever;
    void restart(Duration after) { due = clock->when(after); }
    bool expires() {
      const bool now = due <= clock->virtual_now();
      due = now ? kNever : due;
      return now;
    }
  };
  struct Inputs {
    static std::uint16_t start() { return 0; }
  };
  struct Outputs {
    static void drive(std::uint16_t /*channels*/) {}
  };
  struct Switch {
    static bool asserted() { return false; }
  };
  struct Led {
    static void light(bool /*on*/) {}
  };
  struct Watchdog {
    bool restarts = false;
    static void feed() {}
    void restart() { restarts = true; }
  };

  VirtualClock& clock;
  Line line;
  Timer silence_timer;
  Timer wake_timer;
  Inputs inputs;
  Outputs outputs;
  InstantMemory& memory;
  Switch init_switch;
  Led status_led;
  Watchdog watchdog;
  hal::doubles::KeptWord& kept_word;
  hal::doubles::ImageSlots& slots;
};

class Life {
 public:
  explicit Life(bool allowed) {
    Settings settings = Settings::factory(kModel);
    settings.updates_allowed = allowed;
    memory_.store(kModel, settings);
    images_.push_back(Buffer(4, 0xFF));  // the first image of the double
    start(ResetReason::PowerOn);
  }

  void run(const std::uint8_t* data, const std::uint8_t* end) {
    const auto next = [&] { return data == end ? std::uint8_t{0} : *data++; };
    while (data != end) {
      switch (next()) {
        case 'b': {
          const unsigned size = next() * 37U + 1;
          images_.push_back(update::image_of(size, next()));
          begin_ = update::info_of(image(), static_cast<std::uint16_t>(images_.size()), next());
          ask_begin();
          break;
        }
        case 'c':
          ask_begin();
          break;
        case 'n':
          ask_block(next_offset());
          break;
        case 'k':
          ask_block(next() * update::kBlockSize);
          break;
        case 'l':
          for (unsigned count = next(); count != 0 && next_offset() < image().size(); --count) {
            ask_block(next_offset());
          }
          break;
        case 'a':
          ask({6, 0x10, 0x13, 0, next()});
          break;
        case 'r':
          ask({3, 0x10, 0x10, 0, 3});
          break;
        case 'x': {
          constexpr std::uint8_t kFunctions[] = {3, 4, 6, 0x10};
          Buffer pdu{kFunctions[next() % 4]};
          const unsigned which = next();
          update::append(pdu, (which % 2 == 0 ? 0x1000 : 0x2000) + which / 2, 2);
          pdu.resize(pdu.size() + next() % 80U);
          std::generate(pdu.begin() + 3, pdu.end(), next);
          ask(pdu);
          break;
        }
        case 'd':
          change_after_ = {next(), next()};
          break;
        case 'e':
          change_before_ = {next(), next()};
          break;
        case 'w': {
          const unsigned time = next();
          run_for(milliseconds(time * time));
          break;
        }
        case 'h':
          cut_after_ = std::chrono::microseconds(500 * next());
          break;
        case 'z':
          reset(ResetReason::ResetPin);
          break;
        case 'f':
          failing_ = !failing_;
          has_failed_ = true;
          slots_.fail(failing_);
          break;
        default:
          break;
      }
    }
    reset(ResetReason::PowerOn);
  }

 private:
  struct Change {
    std::uint8_t place = 0;
    std::uint8_t bits = 0;
    void apply(Buffer& to) {
      to[place % to.size()] ^= bits;
      bits = 0;
    }
  };

  const Buffer& image() const { return images_.back(); }
  const update::Update& update() { return device_->module().state().update; }
  std::uint32_t next_offset() { return update().next(); }

  // --- requests ---

  void ask_begin() {
    Buffer data = begin_;
    change_before_.apply(data);
    change_after_.apply(data);
    ask(write_of(0x1000, data));
  }
  void ask_block(std::uint32_t offset) {
    Buffer data = update::block_of(image(), offset);
    data.resize(update::kBlockCheckAt);
    change_before_.apply(data);
    update::append(data, update::crc32({data.data(), data.size()}), 4);
    change_after_.apply(data);
    ask(write_of(0x2000, data));
  }
  static Buffer write_of(std::uint16_t address, const Buffer& data) {
    Buffer pdu{0x10};
    update::append(pdu, address, 2);
    update::append(pdu, static_cast<std::uint32_t>(data.size() / 2), 2);
    update::append(pdu, static_cast<std::uint32_t>(data.size()), 1);
    pdu.insert(pdu.end(), data.begin(), data.end());
    return pdu;
  }

  void ask(const Buffer& pdu) {
    constexpr milliseconds kLongest{500};
    ++requests;
    Buffer frame{1};
    frame.insert(frame.end(), pdu.begin(), pdu.end());
    append_crc(frame);
    device_->board().line.sent.clear();
    const unsigned starts = starts_;
    for (const std::uint8_t byte : frame) {
      device_->on_receive(byte, ByteStatus::Good);
    }
    if (cut_after_) {
      run_for(*std::exchange(cut_after_, std::nullopt));
      reset(ResetReason::PowerOn);
      return;
    }
    const bool was_activating = update().state() == State::Activating;
    for (VirtualTime left = kLongest; left > VirtualTime(0) && reply().empty() && starts_ == starts;) {
      left -= kStep;
      run_for(kStep);
    }
    if (starts_ != starts) {
      require(was_activating || update().state() == State::Unconfirmed, "only an activation resets");
      return;
    }
    Buffer checked = reply();
    require(checked.size() >= 5, "each request gets a reply");
    checked.resize(checked.size() - 2);
    append_crc(checked);
    require(checked == reply(), "the CRC of a reply is right");
    require(checked[0] == 1 && (checked[1] & 0x7FU) == (pdu[0] & 0x7FU), "a reply is one to its request");
  }
  const Buffer& reply() { return device_->board().line.sent; }
  static void append_crc(Buffer& frame) {
    const Crc16 crc = crc16({frame.data(), frame.size()});
    frame.push_back(crc.low_byte());
    frame.push_back(crc.high_byte());
  }

  // --- time ---

  void run_for(VirtualTime time) {
    const VirtualTime end = clock_.virtual_now() + time;
    for (;;) {
      Board& board = device_->board();
      while (!board.watchdog.restarts && device_->turn()) {
      }
      if (board.watchdog.restarts) {
        reset(ResetReason::Software);
        continue;
      }
      if (board.line.sends) {
        board.line.sends = false;
        device_->on_sent();
        continue;
      }
      const VirtualTime next = std::min({board.silence_timer.due, board.wake_timer.due, slots_.next()});
      if (next > end) {
        clock_.set(std::max(end, clock_.virtual_now()));  // a reset takes longer
        return;
      }
      clock_.set(std::max(next, clock_.virtual_now()));
      slots_.run();
      if (board.silence_timer.expires()) {
        device_->on_silence();
      }
      if (board.wake_timer.expires()) {
        device_->on_wake_timer();
      }
    }
  }

  // --- resets ---

  void reset(ResetReason reason) {
    const State state = update().state();
    const bool busy = slots_.busy() || update().busy() || has_failed_;
    const unsigned before = running_;
    require(contents_of(before) == running_contents_, "the running image stays as it is");
    slots_.cut();
    start(reason);
    if (busy) {
      return;
    }
    const bool others = state == State::Activating || state == State::Unconfirmed;
    require((running_ != before) == others, "another image starts if it has been activated, or taken back");
    require(update().state() == State::TakenBack || state != State::Unconfirmed, "an image gets one chance");
  }

  void start(ResetReason reason) {
    ++starts_;
    require(slots_.boot(), "an image starts");
    running_ = slots_.origin().slot;
    running_contents_ = contents_of(running_);
    const update::SlotHead head = slots_.head(running_);
    const update::Info info = update::Slot({head.data(), head.size()}).info;
    Buffer started(running_contents_.begin() + kHead, running_contents_.end());
    started.resize(info.length(), 0xFF);
    require(std::find(images_.begin(), images_.end(), started) != images_.end(),
            "an image that starts is one that a master has sent");
    const update::Signature signature = update::signature_of(kModel, hal::doubles::ImageSlots::kBoard);
    require(std::equal(signature.begin(), signature.end(), info.signature().begin()),
            "an image that starts is for this module");
    device_.emplace(kModel,
                    Board{clock_, {}, {&clock_}, {&clock_}, {}, {}, memory_, {}, {}, {}, kept_word_, slots_});
    device_->start(reason);
    run_for(milliseconds(100));
    require(device_->module().listening(), "a module listens within 100 ms of a reset");
  }

  static constexpr std::size_t kHead = update::kMarksAt;
  /// Header and image, without the marks.
  Buffer contents_of(unsigned slot) {
    const Buffer& all = slots_.contents(slot);
    Buffer contents(all.begin(), all.begin() + kHead);
    if (all.size() > update::kImageAt) {
      contents.insert(contents.end(), all.begin() + update::kImageAt, all.end());
    }
    return contents;
  }

  static constexpr milliseconds kStep{2};
  static inline const Model& kModel = update::the_model();

  VirtualClock clock_;
  InstantMemory memory_;
  hal::doubles::KeptWord kept_word_;
  hal::doubles::ImageSlots slots_{clock_, kModel};
  std::optional<hal::Device<Board>> device_;
  unsigned starts_ = 0;
  unsigned running_ = 0;
  Buffer running_contents_;
  std::vector<Buffer> images_;  ///< that a master has begun to send
  Buffer begin_ = update::info_of(Buffer(4, 0xFF));
  Change change_before_;
  Change change_after_;
  std::optional<VirtualTime> cut_after_;
  bool failing_ = false;
  bool has_failed_ = false;
};

}  // namespace
}  // namespace ex9000::fuzz

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  return std::atexit([] { std::printf("%llu requests\n", ex9000::fuzz::requests); });
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size != 0) {
    ex9000::fuzz::Life(data[0] % 2 == 0).run(data + 1, data + size);
  }
  return 0;
}
