#include "tests/fuzz/byte_code.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "hal/eeprom/two_places.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace ex9000::fuzz {

namespace {

constexpr std::size_t kHeader = 2;
constexpr std::uint8_t kEscape = '\\';

Settings settings_of(const Model& model, Protocol usual, std::uint8_t flags) {
  Settings settings = Settings::factory(model);
  constexpr unsigned kFactoryRate = kFactoryBaudCode - kFirstBaudCode;
  settings.baud_code = static_cast<std::uint8_t>(kFirstBaudCode + (kFactoryRate + flags) % kBaudRates.size());
  settings.format =
      static_cast<std::uint8_t>(((flags & 0x08U) != 0 ? 0x40U : 0U) | ((flags & 0x10U) != 0 ? 0x80U : 0U));
  if ((flags & 0x20U) != 0) {
    settings.watchdog_enabled = true;
    settings.watchdog_timeout = 3;
    settings.power_on_value = static_cast<std::uint16_t>(3U & model.output_mask());
    settings.safe_value = static_cast<std::uint16_t>(4U & model.output_mask());
  }
  const bool modbus = (usual == Protocol::ModbusRtu) != ((flags & 0x40U) != 0);
  settings.protocol = modbus && model.speaks_modbus() ? Protocol::ModbusRtu : Protocol::Ascii;
  return settings;
}

class Life {
 public:
  Life(const Model& model, Protocol usual, std::uint8_t flags)
      : session_(model, model.speaks_modbus() && (flags & 0x10U) != 0) {
    const Settings settings = settings_of(model, usual, flags);
    if (settings != Settings::factory(model)) {
      RecordBytes record{};
      write_record(model, settings, 1, record);
      std::copy(record.begin(), record.end(), session_.around().memory.begin() + hal::kPlaces[0]);
    }
    session_.around().init_asserted = (flags & 0x80U) != 0;
    session_.reset();
  }

  void run(const std::uint8_t* data, std::size_t size) {
    const std::uint8_t* end = data + size;
    while (data != end) {
      const std::uint8_t byte = *data++;
      if (byte != kEscape) {
        put(byte);
      } else if (data != end) {
        const std::uint8_t code = *data++;
        const bool has_number = code == 'g' || code == 'w' || code == 'p' || code == 'h';
        const std::uint8_t number = has_number && data != end ? *data++ : std::uint8_t{0};
        happen(code, number);
      }
    }
  }

  /// Requires that the module still replies to a request to its own address, whatever has happened before.
  void ends() {
    session_.wait_for_quiet();
    const std::uint8_t& address = session_.in_force().address;
    if (session_.speaks_modbus()) {
      const std::array<std::uint8_t, 6> echo{address, 0x08, 0, 0, 1, 2};
      require(session_.ask({echo.data(), echo.size()}).size == echo.size(),
              "a module replies if its line is quiet");
      return;
    }
    session_.byte('\r', ByteStatus::Good);  // ends a command in progress; that command can change the address
    session_.wait_for_quiet();
    const std::array<std::uint8_t, 4> name{'$', upper_hex(address / 16U), upper_hex(address), 'M'};
    require(session_.ask({name.data(), name.size()}).size > 3, "a module replies if its line is quiet");
  }

 private:
  static constexpr Microseconds kSilence = 250 * kMillisecond;

  void put(std::uint8_t byte) {
    session_.byte(byte, status_, gap_);
    gap_ = 0;
    status_ = ByteStatus::Good;
    if (byte == '\r' && !session_.speaks_modbus()) {
      frame_size_ = 0;
    } else if (frame_size_ < frame_.size()) {
      frame_[frame_size_++] = byte;
    }
  }

  void put_check() {
    if (session_.speaks_modbus()) {
      const std::uint16_t crc = crc16(frame_.data(), frame_size_);
      put(static_cast<std::uint8_t>(crc % 256));
      put(static_cast<std::uint8_t>(crc / 256));
    } else if (session_.in_force().checksum) {
      const std::uint8_t sum = dcon_sum(frame_.data(), frame_size_);
      put(upper_hex(sum / 16U));
      put(upper_hex(sum));
    }
  }

  void pause(Microseconds time) {
    session_.wait(time);
    frame_size_ = 0;
  }

  void happen(std::uint8_t code, unsigned number) {
    switch (code) {
      case kEscape:
        return put(kEscape);
      case 'c':
        return put_check();
      case 's':
        return pause(kSilence);
      case 'g':
        gap_ = session_.silence() * number / 64;
        frame_size_ = 0;
        return;
      case 'w':
        return pause(number * number * kMillisecond);
      case 'f':
        status_ = ByteStatus::FramingError;
        return;
      case 'y':
        status_ = ByteStatus::ParityError;
        return;
      case 'b':
        status_ = ByteStatus::Break;
        return;
      case 'o':
        status_ = ByteStatus::Overrun;
        return;
      case 'p':
        for (const std::uint8_t byte = frame_size_ == 0 ? std::uint8_t{0} : frame_[frame_size_ - 1];
             number != 0; --number) {
          put(byte);
        }
        return;
      case 'h':
        return session_.hold(number * kMillisecond / 10);
      case 't':
        return session_.tick();
      case 'i':
        session_.around().init_asserted = !session_.around().init_asserted;
        return session_.tick();
      case 'm':
        session_.around().memory_answers = !session_.around().memory_answers;
        return;
      case 'r':
        frame_size_ = 0;
        return session_.reset();
      default:
        if (code >= '0' && code <= '7') {
          session_.toggle_input(code - '0');
        }
    }
  }

  Session session_;
  Microseconds gap_ = 0;
  ByteStatus status_ = ByteStatus::Good;
  std::array<std::uint8_t, 260> frame_;
  std::size_t frame_size_ = 0;
};

/// Returns the index after the code at `at`, or after the byte at `at` if no code begins there.
std::size_t behind(const std::uint8_t* data, std::size_t size, std::size_t at) {
  if (data[at] != kEscape || at + 1 == size) {
    return at + 1;
  }
  return std::min(size, at + (std::strchr("gwph", data[at + 1]) != nullptr && data[at + 1] != 0 ? 3 : 2));
}

bool is_code(const std::uint8_t* data, std::size_t size, std::size_t at, char code) {
  return at + 1 < size && data[at] == kEscape && data[at + 1] == static_cast<std::uint8_t>(code);
}

/// In Modbus, replaces the two bytes before each gap with `\c` if at least four plain bytes directly precede
/// the gap. In ASCII, inserts `\c` before a CR if at least three plain bytes directly precede this CR, and if
/// the size with `\c` is at most `most`. A plain byte is a byte that belongs to no code and, in ASCII, is not
/// CR. Returns the new size in bytes.
std::size_t mend(std::uint8_t* data, std::size_t size, std::size_t most, bool modbus) {
  std::size_t plain = 0;  // consecutive plain bytes directly before `at`
  for (std::size_t at = kHeader; at < size;) {
    const std::size_t next = behind(data, size, at);
    const bool gap =
        is_code(data, size, at, 's') || is_code(data, size, at, 'g') || is_code(data, size, at, 'w');
    if (modbus && gap && plain >= 4) {
      data[at - 2] = kEscape;
      data[at - 1] = 'c';
    } else if (!modbus && data[at] == '\r' && plain >= 3 && size + 2 <= most) {
      std::memmove(data + at + 2, data + at, size - at);
      data[at] = kEscape;
      data[at + 1] = 'c';
      size += 2;
      at += 3;
      plain = 0;
      continue;
    }
    plain = data[at] == kEscape || (!modbus && data[at] == '\r') ? 0 : plain + 1;
    at = next;
  }
  return size;
}

}  // namespace

void live(const Model& model, Protocol usual, const std::uint8_t* data, std::size_t size) {
  if (size < kHeader) {
    return;
  }
  Life life(model, usual, data[1]);
  life.run(data + kHeader, size - kHeader);
  life.ends();
}

std::size_t mutate(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed, bool modbus) {
  const std::size_t mutated = LLVMFuzzerMutate(data, size, most);
  constexpr unsigned kMendOneIn = 4;
  return seed % kMendOneIn == 0 ? mend(data, mutated, most, modbus) : mutated;
}

}  // namespace ex9000::fuzz
