#include "tests/registers/cut_bench.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/modbus_frame.hpp"

namespace ex9000::registers {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr milliseconds kComesUpWithin{100};
constexpr milliseconds kStoresWithin{600};  // a timeout that is waited for
constexpr std::uint16_t kDriven = 0xC35A;   // by a command, before the one that stores

constexpr unsigned kWaysAByteIsLeft = 5;
/// A byte that was about to change when the power failed.
std::uint8_t left(unsigned way, std::uint8_t old_byte, std::uint8_t new_byte) {
  const std::array<std::uint8_t, kWaysAByteIsLeft> ways{old_byte, new_byte, 0x00, 0xFF,
                                                        static_cast<std::uint8_t>(new_byte ^ 0x5AU)};
  return ways.at(way);
}

std::uint8_t hex_byte(const std::string& text, std::size_t at) {
  return static_cast<std::uint8_t>(std::stoul(text.substr(at, 2), nullptr, 16));
}

std::uint16_t word(const std::vector<std::uint8_t>& reply, std::size_t at) {
  return static_cast<std::uint16_t>(reply.at(at) << 8U | reply.at(at + 1));
}

}  // namespace

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
  bench_.power_on();
  while (!uart().enabled() && bench_.timeline.now() < bench_.began + kComesUpWithin) {
    bench_.run_for(milliseconds(1));
  }
  ASSERT_TRUE(uart().enabled()) << "it does not come up";
}

CutBench::Manner CutBench::speak_as(const Settings& settings, bool init_mode) {
  bench_.line.set_baud(baud_rate(init_mode ? kFactoryBaudCode : settings.baud_code));
  if (init_mode) {
    return {Protocol::Ascii, 0, false};
  }
  return {settings.protocol, settings.address, (settings.format & kFormatChecksum) != 0};
}

/// Framed. The line is quiet for long enough before.
void CutBench::send(const Manner& manner, const Bytes& request) {
  bench_.run_for(40 * bench_.line.bit_time() + microseconds(1800));
  bench_.line.heard.clear();
  bench_.line.drives.clear();
  bench_.line.send(manner.protocol == Protocol::Ascii
                       ? ascii_frame({request.begin(), request.end()}, manner.checksum)
                       : with_crc(request));
}

/// Without its frame; nothing where none begins within 25 ms.
CutBench::Bytes CutBench::hear() {
  while (bench_.line.sending()) {
    bench_.run_for(microseconds(500));
  }
  const Instant gives_up = bench_.timeline.now() + milliseconds(25);
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

/// The reply without CRC.
CutBench::Bytes CutBench::ask(const Manner& manner, const Bytes& request) {
  send(manner, request);
  Bytes reply = hear();
  if (reply.size() < 4) {
    return {};
  }
  const Bytes body(reply.begin(), reply.end() - 2);
  EXPECT_EQ(with_crc(body), reply);
  return body;
}

/// A command by its delimiter and what is behind its address; its reply without checksum and CR.
std::string CutBench::ask(const Manner& manner, const std::string& command) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  const std::string text =
      command.substr(0, 1) + kDigits[manner.address / 16] + kDigits[manner.address % 16] + command.substr(1);
  send(manner, {text.begin(), text.end()});
  const Bytes reply = hear();
  const std::size_t frame = manner.checksum ? 3 : 1;
  if (reply.size() <= frame) {
    return {};
  }
  const std::string body(reply.begin(), reply.end() - static_cast<std::ptrdiff_t>(frame));
  EXPECT_EQ(ascii_frame(body, manner.checksum), reply);
  return body;
}

std::optional<Settings> CutBench::read_ascii(const Manner& manner) {
  const std::string configuration = ask(manner, std::string("$2"));
  if (configuration.size() != 9) {
    return std::nullopt;
  }
  Settings settings;
  settings.address = hex_byte(configuration, 1);
  settings.baud_code = hex_byte(configuration, 5);
  settings.format = hex_byte(configuration, 7);
  settings.protocol = ask(manner, std::string("$P")).at(4) == '1' ? Protocol::ModbusRtu : Protocol::Ascii;
  settings.name = Name(std::string_view(ask(manner, std::string("$M")).substr(3)));
  settings.timeout_status = (hex_byte(ask(manner, std::string("~0")), 3) & 0x04U) != 0;
  const std::string watchdog = ask(manner, std::string("~2"));
  settings.watchdog_enabled = watchdog.at(3) == '1';
  settings.watchdog_timeout = hex_byte(watchdog, 4);
  if (model_.outputs != 0) {
    const auto value = [&](const char* command) {
      const std::string reply = ask(manner, std::string(command));
      return static_cast<std::uint16_t>(hex_byte(reply, 3) << 8U | hex_byte(reply, 5));
    };
    settings.power_on_value = value("~4P");
    settings.safe_value = value("~4S");
  }
  return settings;
}

std::optional<Settings> CutBench::read_modbus(const Manner& manner, std::uint8_t format) {
  const auto registers = [&](std::uint8_t low, std::uint8_t count) {
    return ask(manner, Bytes{manner.address, 0x03, 0x01, low, 0x00, count});
  };
  const auto coil = [&](std::uint8_t low) {
    return ask(manner, Bytes{manner.address, 0x01, 0x01, low, 0x00, 0x01}).at(3) == 1;
  };
  const Bytes address_and_rate = registers(0xE4, 2);
  if (address_and_rate.size() != 7) {
    return std::nullopt;
  }
  Settings settings;
  settings.address = static_cast<std::uint8_t>(word(address_and_rate, 3));
  settings.baud_code = static_cast<std::uint8_t>(word(address_and_rate, 5));
  settings.format = format;
  settings.protocol = coil(0x00) ? Protocol::ModbusRtu : Protocol::Ascii;
  settings.watchdog_timeout = static_cast<std::uint8_t>(word(registers(0xE8, 1), 3));
  settings.watchdog_enabled = coil(0x04);
  settings.timeout_status = coil(0x0D);
  const Bytes identification = ask(manner, Bytes{manner.address, 0x11});
  settings.name = Name(std::string_view(std::string(identification.begin() + 6, identification.end())));
  if (model_.outputs != 0) {
    const auto value = [&](std::uint8_t row) {
      const Bytes reply = ask(manner, Bytes{manner.address, 0x01, 0x00, row, 0x00, 0x10});
      return static_cast<std::uint16_t>(reply.at(3) | reply.at(4) << 8U);
    };
    settings.safe_value = value(0x80);
    settings.power_on_value = value(0xA0);
  }
  return settings;
}

Found CutBench::come_up(const Contents& contents, const std::vector<Settings>& guesses, bool thoroughly) {
  Found found;
  std::optional<std::uint8_t> format;
  if (thoroughly) {
    power_up(contents, true);
    const std::string reply = ask(speak_as(Settings(), true), std::string("$2"));
    EXPECT_EQ(reply.size(), 9U) << reply;
    format = hex_byte(reply, 7);
  }
  power_up(contents, false);
  found.outputs = bench_.outputs();
  for (const Settings& guess : guesses) {
    const Manner manner = speak_as(guess, false);
    found.settings = manner.protocol == Protocol::Ascii ? read_ascii(manner)
                                                        : read_modbus(manner, format.value_or(guess.format));
    if (found.settings) {
      break;
    }
  }
  EXPECT_EQ(bench_.outputs(), found.outputs) << "reading has changed them";
  EXPECT_EQ(CutBench::contents(), contents) << "coming up has written";
  return found;
}

/// What a cut now may leave. While a page is programmed, byte by byte from either end, each byte is another
/// point.
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

void CutBench::set_outputs(const Manner& manner) {
  if (manner.protocol == Protocol::Ascii) {
    ASSERT_EQ(ask(manner, std::string("@C35A")), ">");
  } else {
    const Bytes reply =
        ask(manner, Bytes{manner.address, 0x0F, 0, 0, 0, 16, 2, kDriven & 0xFFU, kDriven >> 8U});
    ASSERT_EQ(reply, (Bytes{manner.address, 0x0F, 0, 0, 0, 16}));
  }
  ASSERT_EQ(bench_.outputs(), kDriven);
}

/// Until it is stored and answered, and everything is quiet again.
void CutBench::carry_out(const Manner& manner, const StoringCommand& command, const Settings& before) {
  const std::size_t had_programmed = bench_.eeprom.programmed().size();
  if (!command.is_timeout()) {
    send(manner, command.frame(before));
    while (bench_.line.sending()) {
      bench_.run_for(microseconds(500));
    }
  }
  const Instant gives_up = bench_.timeline.now() + kStoresWithin;
  while (bench_.timeline.now() < gives_up && bench_.eeprom.programmed().size() == had_programmed) {
    bench_.run_for(milliseconds(1));
  }
  ASSERT_EQ(bench_.eeprom.programmed().size(), had_programmed + 1) << "it stores nothing";
  if (command.answered) {
    const Bytes reply = hear();
    ASSERT_GE(reply.size(), 3U) << "no answer";
    EXPECT_TRUE(manner.protocol == Protocol::Ascii ? reply[0] == '!' : reply[1] < 0x80U) << "refused";
  }
  bench_.run_for(milliseconds(10));  // what is stored is read back
}

std::uint16_t CutBench::outputs_before(const Settings& settings) const {
  if (model_.outputs == 0) {
    return 0;
  }
  return settings.timeout_status ? settings.safe_value : kDriven;
}

CutBench::Manner CutBench::get_ready(const Contents& contents, const Settings& before,
                                     const StoringCommand& command) {
  const bool init_mode = command.init == Init::SinceReset;
  power_up(contents, init_mode);
  const Manner manner = speak_as(before, init_mode);
  if (model_.outputs != 0 && !before.timeout_status) {
    set_outputs(manner);
  }
  if (command.init == Init::Tied) {
    bench_.set_init(true);
    bench_.run_for(milliseconds(15));
  }
  EXPECT_EQ(bench_.outputs(), outputs_before(before));
  bench_.line.drives.clear();
  return manner;
}

Cuts CutBench::cut_everywhere(const Contents& contents, const Settings& before,
                              const StoringCommand& command) {
  Cuts cuts;
  const Manner manner = get_ready(contents, before, command);
  const Instant began = bench_.timeline.now();
  cuts.outputs = bench_.outputs();
  const Settings done = command.done_to(before, cuts.outputs);
  const std::uint16_t outputs_done = command.drive ? command.drive(done, cuts.outputs) : cuts.outputs;
  bench_.eeprom.on_event([&] {
    note_cuts(cuts);
    cuts.events.push_back(bench_.timeline.now() - began);
    if (bench_.eeprom.programming()) {
      // A timeout drives at once, a command when it is stored.
      EXPECT_EQ(bench_.outputs(), command.is_timeout() ? outputs_done : cuts.outputs);
    }
  });
  carry_out(manner, command, before);
  bench_.eeprom.on_event(nullptr);
  ++cuts.points;
  ++cuts.cuts;
  cuts.left[CutBench::contents()] = true;
  EXPECT_EQ(bench_.outputs(), outputs_done);
  return cuts;
}

Contents CutBench::reset_after(Instant time, const Contents& contents, const Settings& before,
                               const StoringCommand& command, bool& certainly_done) {
  const Manner manner = get_ready(contents, before, command);
  const Instant when = bench_.timeline.now() + time;
  if (!command.is_timeout()) {
    send(manner, command.frame(before));
  }
  bench_.run_until(when);
  certainly_done = !bench_.line.drives.empty();
  bench_.set_init(false);
  bench_.reset();
  bench_.run_for(kComesUpWithin);
  EXPECT_TRUE(uart().enabled()) << "it does not come up";
  return CutBench::contents();
}

}  // namespace ex9000::registers
