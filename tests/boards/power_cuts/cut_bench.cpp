#include "tests/boards/power_cuts/cut_bench.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/stored_settings.hpp"

namespace ex9000::registers {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr milliseconds kComesUpWithin{100};
constexpr milliseconds kRepliesWithin{25 + kLongestResponseDelay};
constexpr std::size_t kAroundSettings = 8;  // bytes of layout, length, sequence and check
constexpr milliseconds kStoresWithin{600};  // includes the wait until the host watchdog expires
constexpr std::uint16_t kDriven = 0xC35A;   // the outputs before a command, if the timeout status is not set

/// The size in bytes of the smallest page write that Attempt::tries counts. A write that invalidates a copy
/// has 8 bytes.
constexpr unsigned kSmallestTry = 20;

constexpr unsigned kWaysAByteIsLeft = 5;
/// Returns one of the values that a byte may have if the power fails while the byte changes.
std::uint8_t left(unsigned way, std::uint8_t old_byte, std::uint8_t new_byte) {
  const std::array<std::uint8_t, kWaysAByteIsLeft> ways{old_byte, new_byte, 0x00, 0xFF,
                                                        static_cast<std::uint8_t>(new_byte ^ 0x5AU)};
  return ways.at(way);
}

}  // namespace

constexpr std::size_t pages_of(std::size_t bytes) { return (bytes + kStoredPage - 1) / kStoredPage; }

/// Returns the number of page writes when a module with `contents` stores `settings`.
std::size_t CutBench::pages_of_a_store(const Contents& contents, const Settings& settings) const {
  const std::size_t place = place_that_counts(model_, contents.data());
  const std::size_t present = place == kStoredMemory ? 0 : StoredCopy(model_, contents.data(), place).size();
  // The firmware does not shorten a record of newer firmware.
  return present > StoredCopy::bytes_of_all() + kAroundSettings
             ? pages_of(present)
             : pages_of(StoredCopy::bytes_of(settings) + kAroundSettings);
}

CutBench::CutBench(const Image& image, const Model& model) : model_(model), bench_(image) {
  for (unsigned channel = 0; channel < image.outputs; ++channel) {
    bench_.net(image.output_pins.at(channel)).on_change([this] {
      ++shown_.changes;
      shown_.ever_on |= bench_.outputs();
    });
  }
}

Outputs CutBench::outputs() {
  Outputs outputs = shown_;
  outputs.now = bench_.outputs();
  return outputs;
}

Contents CutBench::contents() const {
  Contents contents{};
  std::copy_n(bench_.memory.begin(), contents.size(), contents.begin());
  return contents;
}

void CutBench::power_up(const Contents& contents, bool init) {
  if (bench_.powered()) {
    bench_.power_off();
  }
  bench_.set_init(init);
  std::copy(contents.begin(), contents.end(), bench_.memory.begin());
  bench_.line.heard.clear();
  bench_.line.drives.clear();
  shown_ = Outputs();
  bench_.power_on();
  while (!uart().enabled() && bench_.timeline.now() < bench_.began + kComesUpWithin) {
    bench_.run_for(milliseconds(1));
  }
  ASSERT_TRUE(uart().enabled()) << "the module does not start";
}

FrameFormat CutBench::speak_as(const Settings& settings, bool init_mode) {
  const std::uint8_t baud_code = init_mode ? kFactoryBaudCode : settings.baud_code;
  bench_.line.set_baud(baud_rate(baud_code));
  bench_.line.set_format(line_format(baud_code));
  return init_mode ? FrameFormat::init_mode() : FrameFormat::of(settings);
}

/// Waits for longer than the silence T3.5 of Modbus RTU, and then begins to send `frame`.
void CutBench::send(const Bytes& frame) {
  bench_.run_for(40 * bench_.line.bit_time() + microseconds(1800));
  bench_.line.heard.clear();
  bench_.line.drives.clear();
  bench_.line.send(frame);
}

/// Waits until the request has been sent and its reply has ended, and returns the reply. Returns an empty
/// vector if no reply has begun within kRepliesWithin after the end of the request or after the call,
/// whichever is later.
CutBench::Bytes CutBench::hear() {
  while (bench_.line.sending()) {
    bench_.run_for(microseconds(500));
  }
  const Instant gives_up = bench_.timeline.now() + kRepliesWithin;
  const auto& drives = bench_.line.drives;
  while (drives.empty() ? bench_.timeline.now() < gives_up : drives.back().to == kNever) {
    bench_.run_for(microseconds(500));
  }
  Bytes reply;
  for (const LineBench::Heard& each : bench_.line.heard) {
    reply.push_back(each.byte);
  }
  return reply;
}

SettingsReader CutBench::master(const FrameFormat& frame_format) {
  return {model_, frame_format, [this](const Bytes& frame) {
            send(frame);
            return hear();
          }};
}

Found CutBench::come_up(const Contents& contents, const std::vector<Settings>& guesses, bool thoroughly) {
  Found found;
  std::optional<std::uint8_t> format;
  if (thoroughly) {
    power_up(contents, true);
    const std::string reply = master(speak_as(Settings(), true)).ask(std::string("$2"));
    EXPECT_EQ(reply.size(), 9U) << reply;
    format = hex_byte(reply, 7);
  }
  power_up(contents, false);
  found.outputs = outputs();
  for (const Settings& guess : guesses) {
    found.settings = master(speak_as(guess, false)).read(format.value_or(guess.format));
    if (found.settings) {
      break;
    }
  }
  EXPECT_EQ(shown_.changes, found.outputs.changes) << "reading has changed outputs";
  EXPECT_EQ(CutBench::contents(), contents)
      << "the module has written to the EEPROM without a command that stores";
  return found;
}

/// Adds to `cuts` the contents that a cut at this time may leave. The EEPROM may program a page byte by byte
/// from either end, and each byte is a separate point.
void CutBench::note_cuts(Cuts& cuts) {
  const bool done = !bench_.line.drives.empty();
  const auto note = [&](const Contents& contents) {
    bool& certainly = cuts.left[contents];
    certainly = certainly || done;
    ++cuts.cuts;
  };
  ++cuts.points;
  const std::vector<EepromChip::Cell> cells = bench_.eeprom.being_programmed();
  if (cells.empty()) {
    note(contents());
    return;
  }
  for (const bool ascending : {true, false}) {
    Contents contents = CutBench::contents();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const EepromChip::Cell cell = cells[ascending ? i : cells.size() - 1 - i];
      std::uint8_t& byte = contents.at(cell.place);
      const std::uint8_t old_byte = byte;
      for (unsigned way = 0; way < kWaysAByteIsLeft; ++way) {
        byte = left(way, old_byte, cell.value);
        note(contents);
      }
      byte = cell.value;
    }
  }
  cuts.points += cells.size() - 1;
}

void CutBench::set_outputs(const FrameFormat& frame_format) {
  if (frame_format.protocol == Protocol::Ascii) {
    ASSERT_EQ(master(frame_format).ask(std::string("@C35A")), ">");
  } else {
    const Bytes reply = master(frame_format).ask(Bytes{0x0F, 0, 0, 0, 16, 2, kDriven & 0xFFU, kDriven >> 8U});
    ASSERT_EQ(reply, (Bytes{frame_format.address, 0x0F, 0, 0, 0, 16}));
  }
  ASSERT_EQ(bench_.outputs(), kDriven);
}

/// Sends the command, or waits until the host watchdog expires. Returns when `pages` pages are programmed and
/// verified, and the reply, if the command has one, is sent. Checks that the module accepts the command.
void CutBench::carry_out(const FrameFormat& frame_format, const StoringCommand& command,
                         const Settings& before, std::size_t pages) {
  const std::size_t had_programmed = bench_.eeprom.programmed().size();
  if (!command.is_timeout()) {
    send(frame_format.framed(command.frame(before)));
    while (bench_.line.sending()) {
      bench_.run_for(microseconds(500));
    }
  }
  const Instant gives_up = bench_.timeline.now() + kStoresWithin;
  while (bench_.timeline.now() < gives_up && bench_.eeprom.programmed().size() < had_programmed + pages) {
    bench_.run_for(milliseconds(1));
  }
  ASSERT_EQ(bench_.eeprom.programmed().size(), had_programmed + pages)
      << "the module does not program the expected number of pages";
  if (command.answered) {
    const Bytes reply = hear();
    ASSERT_GE(reply.size(), 3U) << "no reply";
    EXPECT_TRUE(frame_format.protocol == Protocol::Ascii ? reply[0] == '!' : reply[1] < 0x80U) << "refused";
  }
  bench_.run_for(milliseconds(10));  // if there is no reply, the last page is possibly not yet verified
}

std::uint16_t CutBench::outputs_before(const Settings& settings) const {
  if (model_.outputs == 0) {
    return 0;
  }
  return settings.timeout_status ? settings.safe_value : kDriven;
}

FrameFormat CutBench::get_ready(const Contents& contents, const Settings& before,
                                const StoringCommand& command) {
  const bool init_mode = command.init == Init::SinceReset;
  power_up(contents, init_mode);
  const FrameFormat frame_format = speak_as(before, init_mode);
  if (model_.outputs != 0 && !before.timeout_status) {
    set_outputs(frame_format);
  }
  if (command.init == Init::Tied) {
    bench_.set_init(true);
    bench_.run_for(milliseconds(25));  // a change of INIT* takes effect within 20 ms: wire.md D13
  }
  EXPECT_EQ(bench_.outputs(), outputs_before(before));
  bench_.line.drives.clear();
  return frame_format;
}

Cuts CutBench::cut_everywhere(const Contents& contents, const Settings& before,
                              const StoringCommand& command) {
  Cuts cuts;
  const FrameFormat frame_format = get_ready(contents, before, command);
  const Instant began = bench_.timeline.now();
  cuts.outputs = bench_.outputs();
  const Settings done = command.done_to(before, cuts.outputs);
  const std::uint16_t outputs_done = command.drive ? command.drive(done, cuts.outputs) : cuts.outputs;
  bench_.eeprom.on_event([&] {
    note_cuts(cuts);
    cuts.events.push_back(bench_.timeline.now() - began);
    if (bench_.eeprom.programming()) {
      // A timeout of the host watchdog changes the outputs immediately. A command changes them after the
      // store.
      EXPECT_EQ(bench_.outputs(), command.is_timeout() ? outputs_done : cuts.outputs);
    }
  });
  carry_out(frame_format, command, before, pages_of_a_store(contents, done));
  bench_.eeprom.on_event(nullptr);
  ++cuts.points;
  ++cuts.cuts;
  cuts.left[CutBench::contents()] = true;
  EXPECT_EQ(bench_.outputs(), outputs_done);
  return cuts;
}

Attempt CutBench::attempt(const Contents& contents, const Settings& before, const StoringCommand& command,
                          std::uint16_t place, std::uint8_t bits, std::uint8_t stuck) {
  constexpr milliseconds kTriedAgain{1300};  // longer than the interval of the retries, 1 s (wire.md D15)
  Attempt attempt;
  const FrameFormat frame_format = get_ready(contents, before, command);
  EepromChip& eeprom = bench_.eeprom;
  eeprom.wear_out(place, bits, stuck);
  attempt.outputs_before = bench_.outputs();
  const unsigned had_spoiled = eeprom.spoiled();
  const std::size_t had_programmed = eeprom.programmed().size();
  eeprom.on_event([&] {
    (bench_.line.drives.empty() ? attempt.meanwhile : attempt.behind).push_back(CutBench::contents());
  });
  if (!command.is_timeout()) {
    send(frame_format.framed(command.frame(before)));
    while (bench_.line.sending()) {
      bench_.run_for(microseconds(100));
    }
  }
  const Instant asked = bench_.timeline.now();
  bench_.run_for(kStoresWithin);
  attempt.tries = static_cast<unsigned>(std::count_if(
      eeprom.programmed().begin() + static_cast<std::ptrdiff_t>(had_programmed), eeprom.programmed().end(),
      [](const EepromChip::Programmed& page) { return page.size >= kSmallestTry; }));
  attempt.spoiled = eeprom.spoiled() - had_spoiled;
  if (command.answered) {
    attempt.reply = hear();
    attempt.reply_after = bench_.line.drives.empty() ? kNever : bench_.line.drives.front().from - asked;
  }
  bench_.run_for(kTriedAgain);
  eeprom.on_event(nullptr);
  eeprom.renew();
  attempt.behind.push_back(CutBench::contents());
  attempt.outputs = bench_.outputs();
  return attempt;
}

AfterReset CutBench::reset_after(Instant time, const Contents& contents, const Settings& before,
                                 const StoringCommand& command) {
  const FrameFormat frame_format = get_ready(contents, before, command);
  const Instant when = bench_.timeline.now() + time;
  if (!command.is_timeout()) {
    send(frame_format.framed(command.frame(before)));
  }
  bench_.run_until(when);
  const bool certainly_done = !bench_.line.drives.empty();
  bench_.set_init(false);
  const std::uint16_t outputs_before_it = bench_.outputs();
  shown_ = Outputs();
  bench_.reset();
  // A reset switches all outputs off before any code runs.
  EXPECT_EQ(shown_.ever_on & ~outputs_before_it, 0);
  EXPECT_EQ(bench_.outputs(), 0);
  shown_ = Outputs();
  bench_.run_for(kComesUpWithin);
  EXPECT_TRUE(uart().enabled()) << "the module does not start";
  return {CutBench::contents(), certainly_done, outputs()};
}

}  // namespace ex9000::registers
