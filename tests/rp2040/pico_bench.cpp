#include "tests/rp2040/pico_bench.hpp"

#include <algorithm>
#include <sstream>
#include <type_traits>

#include EX9000_BOARD_HEADER
#include "hal/flash/record_log.hpp"
#include "hal/pins/single_pins.hpp"
#include "sim/text/values.hpp"
#include "sim/virtual_line/wires/module.hpp"

namespace ex9000::pico {

namespace {

using play::Bytes;
using std::chrono::nanoseconds;

std::string hex_of(const Bytes& bytes) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string hex;
  for (const std::uint8_t byte : bytes) {
    hex += kDigits[byte >> 4U];
    hex += kDigits[byte & 0xFU];
  }
  return hex;
}

Bytes bytes_of(const std::string& hex) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

/// Returns the argument DRIVER-ENABLE of the emulator.
[[maybe_unused]] std::string driver_enable(board::Pin pin) { return std::to_string(pin.number); }
[[maybe_unused]] std::string driver_enable(hal::NoPin /*pin*/) { return "none"; }

template <class Groups>
unsigned pin_of(const Groups& groups, unsigned channel) {
  for (const board::PinGroup& group : groups) {
    if (channel < group.count) {
      return group.first_pin + channel;
    }
    channel -= group.count;
  }
  throw std::out_of_range("channel: the board has no pin for it; expected a channel of kInputs or kOutputs");
}

/// Returns a sector of the log with `records`, each of which has kRecordRoom bytes.
Bytes sector_with(const Bytes& records) {
  Bytes sector(kRecordRoom, 0xFF);
  std::fill_n(sector.begin(), hal::flash::kMark.size(), std::uint8_t{0});
  sector.insert(sector.end(), records.begin(), records.end());
  return sector;
}

Bytes memory_with(const Model& model, const Settings& settings) {
  const auto memory = sim::SimulatedModule::memory_image(model, settings);
  return {memory.begin(), memory.end()};
}

}  // namespace

std::string image_of(const Model& model, Memory memory) {
  const char* preset = memory == Memory::Flash ? EX9000_BOARD : EX9000_BOARD "-eeprom";
  return "build/" + (preset + ("/" + std::string(model.designation))) + ".bin";
}

void PicoBench::begin_with(const std::string& file) {
  constexpr unsigned kTransmit = board::kUartPins.first_pin;
  powered_ = false;
  execute("new " + file + " " + std::to_string(kTransmit) + " " + std::to_string(kTransmit + 1U) + " " +
          driver_enable(board::kDriverEnable) + " " + std::to_string(board::kI2cPins.first_pin));
  set_baud(9600);
}

void PicoBench::begin_anew(const Model& model, const Settings* settings) {
  begin_anew(model, settings == nullptr ? Bytes() : memory_with(model, *settings));
}

void PicoBench::begin_anew(const Model& model, const Bytes& memory) {
  model_ = &model;
  begin_with(image_of(model, memory_));
  if (memory_ == Memory::Flash) {
    for (unsigned sector = 0; sector < hal::flash::kSectors; ++sector) {
      set_sector(sector, {hal::flash::kMark.begin(), hal::flash::kMark.end()});
    }
  }
  if (memory.empty()) {
    return;
  }
  if (memory_ == Memory::Eeprom) {
    execute("memory " + hex_of(memory));
  } else {
    set_sector(0, sector_with({memory.begin(), memory.begin() + 2 * kRecordRoom}));
  }
}

void PicoBench::forget_erased_sectors() {
  for (unsigned sector = 1; sector < hal::flash::kSectors; ++sector) {
    set_sector(sector, Bytes(hal::flash::kMark.size(), 0xFF));
  }
}

void PicoBench::fill_log(const Settings& settings) {
  std::uint16_t sequence = 0;
  for (unsigned sector = 0; sector < hal::flash::kSectors; ++sector) {
    Bytes records;
    for (unsigned place = 1; place < hal::flash::kPlacesOfASector; ++place) {
      RecordBytes record{};
      write_record(*model_, settings, ++sequence, record);
      records.insert(records.end(), record.begin(), record.end());
    }
    set_sector(sector, sector_with(records));
  }
}

void PicoBench::set_sector(unsigned sector, const Bytes& bytes) {
  execute("set-flash " + std::to_string(board::kSettingsInFlash + sector * hal::kFlashSector) + " " +
          hex_of(bytes));
}

void PicoBench::power(bool on) {
  execute(on ? "power on" : "power off");
  powered_ = on;
}

void PicoBench::reset() { execute("reset"); }

void PicoBench::come_up() {
  run_for(kComingUp);
  if constexpr (std::is_same_v<decltype(board::kDriverEnable), const hal::NoPin>) {
    heard();
  }
}

void PicoBench::run_for(nanoseconds time) { execute("run " + std::to_string(time.count())); }

nanoseconds PicoBench::now() { return nanoseconds(std::stoll(execute("now"))); }

void PicoBench::set_baud(std::uint32_t rate) { execute("baud " + std::to_string(rate)); }

void PicoBench::set_format(LineFormat format) { execute("format " + sim::line_format_text(format)); }

void PicoBench::send(const Bytes& bytes) {
  if (!bytes.empty()) {
    execute("send " + hex_of(bytes));
  }
}

Bytes PicoBench::receive(std::size_t count, nanoseconds patience) {
  return bytes_of(execute("receive " + std::to_string(count) + " " + std::to_string(patience.count())));
}

Bytes PicoBench::heard() { return bytes_of(execute("heard")); }

void PicoBench::set_pin(unsigned number, const char* level) {
  execute("pin " + std::to_string(number) + " " + level);
}

void PicoBench::set_init(bool asserted) { set_pin(board::kInitSwitch.number, asserted ? "low" : "open"); }

void PicoBench::set_input(unsigned channel, bool level) {
  set_pin(pin_of(board::kInputs, channel), level == board::kInputsActiveHigh ? "high" : "low");
}

void PicoBench::pulse_input(unsigned channel, std::uint32_t count, nanoseconds between) {
  // Makes the pulses in parts, so that the emulator replies in time on a busy machine.
  constexpr std::uint32_t kPart = 1000;
  for (; count != 0; count -= std::min(count, kPart)) {
    execute("pulses " + std::to_string(pin_of(board::kInputs, channel)) + " " +
            std::to_string(std::min(count, kPart)) + " " + std::to_string(between.count()));
  }
}

std::uint32_t PicoBench::levels() { return static_cast<std::uint32_t>(std::stoul(execute("levels"))); }

std::uint16_t PicoBench::outputs() {
  const std::uint32_t pins = levels();
  std::uint16_t channels = 0;
  for (unsigned channel = 0; powered_ && channel < model_->outputs; ++channel) {
    const bool high = (pins >> pin_of(board::kOutputs, channel) & 1U) != 0;
    if (high == board::kOutputsActiveHigh) {
      channels = static_cast<std::uint16_t>(channels | 1U << channel);
    }
  }
  return channels;
}

bool PicoBench::led() { return (levels() & board::kStatusLed.mask()) != 0; }

bool PicoBench::led_changes(nanoseconds patience) {
  return execute("watch " + std::to_string(board::kStatusLed.number) + " " +
                 std::to_string(patience.count())) == "1";
}

std::map<std::string, long> PicoBench::counts() {
  std::map<std::string, long> result;
  std::istringstream words(execute("counts"));
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    result[word.substr(0, equals)] = std::stol(word.substr(equals + 1));
  }
  return result;
}

}  // namespace ex9000::pico
