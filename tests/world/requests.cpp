#include "tests/world/requests.hpp"

#include <algorithm>
#include <cctype>
#include <set>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/app/play/transcript.hpp"
#include "sim/text/values.hpp"
#include "tests/oracles/reference/dcon_check.hpp"
#include "tests/oracles/reference/hexadecimal.hpp"

namespace ex9000::world {

namespace {

using reference::Module;
using reference::Random;

/// Requests with the same form have the same length, and the same bytes that select a command or a register.
std::string form_of(const Bytes& frame, bool modbus) {
  const std::size_t first = std::min<std::size_t>(modbus ? 1 : 3, frame.size());
  const std::size_t end = std::min<std::size_t>(first + (modbus ? 3 : 5), frame.size());
  const auto at = [&frame](std::size_t index) { return frame.begin() + static_cast<std::ptrdiff_t>(index); };
  return std::to_string(frame.size()) +
         (modbus ? "" : std::string(at(0), at(std::min<std::size_t>(1, end)))) +
         std::string(at(first), at(end));
}

template <class Set>
const auto& any_of(const Set& set, Random& random) {
  return *std::next(set.begin(), random.below(static_cast<unsigned>(set.size())));
}

std::uint8_t any_byte(Random& random) { return static_cast<std::uint8_t>(random.below(256)); }

/// Changes one value.
void vary(Bytes& frame, bool modbus, const Module& module, Random& random) {
  const std::size_t first = modbus ? 1 : 3;
  if (frame.size() <= first) {
    return;
  }
  std::uint8_t& byte = frame[first + random.below(static_cast<unsigned>(frame.size() - first))];
  if (modbus) {
    const auto channels = static_cast<std::uint8_t>(module.row().inputs + module.row().outputs);
    byte = random.one_of<std::uint8_t>(
        {0, 1, 2, channels, static_cast<std::uint8_t>(byte + 1), static_cast<std::uint8_t>(byte - 1), 0xFF,
         static_cast<std::uint8_t>(byte ^ 1U << random.below(8)), any_byte(random)});
  } else if (random.once_in(8)) {
    byte = static_cast<std::uint8_t>(random.between(0x20, 0x7E));
  } else {
    byte = static_cast<std::uint8_t>(reference::hex(random.below(16), 1)[0]);
  }
}

/// A line with the module's address and, if it is on, the checksum.
Bytes line_of(const Module& module, char delimiter, const std::string& body) {
  const std::string command = delimiter + reference::hex(module.address(), 2) + body;
  const std::string line = command + (module.checksum() ? reference::check_of(command) : "") + "\r";
  return Bytes(line.begin(), line.end());
}

/// extensions.md, scan.
constexpr std::uint8_t kScan = 0xFD;
void by_serial_number(Bytes& frame, unsigned number) {
  const auto byte = [=](unsigned shift) { return static_cast<std::uint8_t>(number >> shift); };
  frame[0] = byte(0);
  const Bytes prefix{kScan, 0x46, 0x08, byte(24), byte(16), byte(8)};
  frame.insert(frame.begin(), prefix.begin(), prefix.end());
}

/// A write of one coil or register, or a read.
Bytes write_of(const Module& module, unsigned function, unsigned row, unsigned value) {
  const auto byte = [](unsigned number) { return static_cast<std::uint8_t>(number % 256); };
  return with_crc(
      {byte(module.address()), byte(function), byte(row / 256), byte(row), byte(value / 256), byte(value)});
}

constexpr unsigned kBlock = 128;

/// Appends a number, high byte first.
void put(Bytes& to, unsigned bytes, unsigned value) {
  while (bytes-- != 0) {
    to.push_back(static_cast<std::uint8_t>(bytes < 4 ? value >> 8 * bytes : 0));
  }
}

/// A write of as many registers as there are words.
Bytes write_all(const Module& module, unsigned first, const Bytes& data) {
  Bytes frame{static_cast<std::uint8_t>(module.address()), 0x10};
  put(frame, 2, first);
  put(frame, 2, static_cast<unsigned>(data.size() / 2));
  put(frame, 1, static_cast<unsigned>(data.size()));
  frame.insert(frame.end(), data.begin(), data.end());
  return with_crc(frame);
}

}  // namespace

Requests::Requests() {
  for (const std::string& path : play::transcript_files(EX9000_CONFORMANCE_DIR)) {
    for (const play::Transcript& run : play::load(path)) {
      if (run.model == nullptr) {
        continue;  // a scenario
      }
      Sequence ascii;
      Sequence modbus;
      for (const play::Step& step : run.steps) {
        const std::string& text = step.text;
        if (text.substr(0, 3) == "=> ") {
          modbus.push_back(sim::parse_hex_bytes(text.substr(3)));
        } else if (text.substr(0, 2) == "> ") {
          ascii.emplace_back(text.begin() + 2, text.end());
        }
      }
      for (Pool* const pool : {&pools_[std::string(run.model->designation)], &all_}) {
        add(pool->ascii, ascii, false);
        add(pool->modbus, modbus, true);
      }
    }
  }
}

void Requests::add(Forms& forms, const Sequence& requests, bool modbus) {
  sequences_.push_back(requests);
  const Sequence& kept = sequences_.back();
  for (std::size_t i = 0; i < kept.size(); ++i) {
    forms[form_of(kept[i], modbus)].push_back({&kept, i, modbus});
  }
}

Bytes Requests::set_filter(const Module& module, unsigned channel, Random& random) {
  const unsigned time = random.one_of({0U, 1U, 20U, 100U, 500U, 2000U, 2001U});
  const unsigned row = 0x0240 + channel;
  return module.runs_modbus() ? write_of(module, 0x06, row, time)
                              : line_of(module, '~', "X" + reference::hex(row, 4) + reference::hex(time, 4));
}

Bytes Requests::of_watchdog(const Module& module, Random& random) {
  const unsigned timeout = 1 + random.below(random.once_in(2) ? 4 : 20);
  const unsigned which = random.below(6);
  if (module.runs_modbus()) {
    return which < 2    ? write_of(module, 0x05, 0x0104, 0xFF00)
           : which == 2 ? write_of(module, 0x06, 0x01E8, timeout)
           : which == 3 ? write_of(module, 0x05, 0x0080 + random.below(module.row().outputs + 1), 0xFF00)
           : which == 4 ? write_of(module, 0x03, 0x3038, 1)  // host OK
                        : write_of(module, 0x05, 0x010D, 0xFF00);
  }
  return which < 3    ? line_of(module, '~', "31" + reference::hex(timeout, 2))
         : which == 3 ? line_of(module, '~', "5S")
         : which == 4 ? line_of(module, '~', "0")
                      : line_of(module, '~', "1");
}

Requests::Image Requests::new_image(const Module& module, Random& random, bool is_long) {
  const unsigned blocks = is_long ? 31 + random.below(10) : 1 + random.below(3);
  const unsigned length = kBlock * (blocks - 1) + 1 + random.below(kBlock);
  Image image;
  for (unsigned i = 0; i < length; ++i) {
    image.content.push_back(any_byte(random));
  }
  const std::uint32_t crc = reference::crc32(image.content, length) ^ (random.once_in(12) ? 1U : 0U);
  image.content.resize(kBlock * blocks, 0xFF);
  const std::string signature = module.signature();
  image.begin.assign(signature.begin(), signature.end());
  image.begin.resize(12);
  put(image.begin, 4, length);
  put(image.begin, 2, random.below(10) << 8 | random.below(10) << 4 | random.below(10));
  put(image.begin, 2, random.once_in(3) ? 1 : 0);
  put(image.begin, 4, crc);
  put(image.begin, 8, 0);
  return image;
}

Bytes Requests::block(const Module& module, const Image& image, std::size_t offset) {
  Bytes data;
  put(data, 4, static_cast<unsigned>(offset));
  const std::size_t first = std::min(offset / kBlock * kBlock, image.content.size() - kBlock);
  const auto from = image.content.begin() + static_cast<std::ptrdiff_t>(first);
  data.insert(data.end(), from, from + kBlock);
  put(data, 4, reference::crc32(data, data.size()));
  return write_all(module, 0x2000, data);
}

Bytes Requests::broadcast(Bytes request) {
  request.resize(request.size() - 2);
  request[0] = 0;
  return with_crc(request);
}

Bytes Requests::state_of_update(const Module& module) { return write_of(module, 0x03, 0x1010, 3); }

Bytes Requests::by_number(const Module& module, Bytes request) {
  request.resize(request.size() - 2);
  by_serial_number(request, module.serial_number());
  return with_crc(request);
}

Bytes Requests::of_update(const Module& module, Random& random, Image& image, bool may_be_long) {
  using State = reference::UpdateState;
  const reference::Update& update = module.update();
  const bool known = !image.begin.empty() && update.spare.begin == image.begin;
  const bool may_begin = update.state == State::None || update.state == State::TakenBack ||
                         update.state == State::Failed || (update.state == State::Receiving && !known);
  if (image.begin.empty() || (may_begin && random.once_in(2))) {
    image = new_image(module, random, may_be_long);
  }
  // Mostly one that is there already, or the one after the next.
  const auto any_block = [&] {
    const std::size_t there = update.state == State::Receiving ? update.spare.size() : image.content.size();
    const std::size_t offset = random.below(static_cast<unsigned>(there / kBlock + 2)) * kBlock;
    if (random.once_in(3)) {
      Image other = image;
      const std::size_t changed = offset + random.below(kBlock);
      other.content[std::min(changed, other.content.size() - 1)] ^= 1U;
      return block(module, other, offset);
    }
    return block(module, image, offset);
  };
  const auto action = [&](unsigned value) { return write_of(module, 0x06, 0x1013, value); };
  if (random.once_in(8)) {
    return state_of_update(module);
  }
  if (random.once_in(7)) {
    return random.once_in(3) ? action(random.between(1, 3)) : any_block();
  }
  if (random.once_in(20)) {
    Bytes wrong = image.begin;
    if (random.once_in(3)) {
      wrong[13] = 1;  // a length of about 64 to 128 KiB
      wrong[14] = random.one_of<std::uint8_t>({0xEF, 0xF0, 0xF0, 0xF1});
      wrong[15] = random.one_of<std::uint8_t>({0x00, 0x01});
    } else {
      wrong[random.below(static_cast<unsigned>(wrong.size()))] ^=
          static_cast<std::uint8_t>(1U << random.below(8));
    }
    return write_all(module, 0x1000, wrong);
  }
  if (may_begin || random.once_in(20)) {
    return write_all(module, 0x1000, image.begin);
  }
  switch (update.state) {
    case State::Receiving:
      return block(module, image, update.spare.size());
    case State::Complete:
      return action(1);
    default:
      return random.once_in(4)   ? action(2)
             : random.once_in(3) ? write_of(module, 0x03, 0x0300, 2)
             : random.once_in(2) ? any_block()
                                 : write_of(module, 0x03, 0x00FA, 6);
  }
}

Bytes Requests::next(const Module& module, Random& random, Place& place) const {
  const bool modbus = module.runs_modbus() != (module.row().both_protocols && random.once_in(50));
  const Pool& pool = random.once_in(4) ? all_ : pools_.at(module.row().designation);
  if (place.requests == nullptr || place.modbus != modbus || ++place.next == place.requests->size() ||
      random.once_in(3)) {
    place = any_of(any_of(modbus ? pool.modbus : pool.ascii, random).second, random);
  }
  Bytes frame = (*place.requests)[place.next];
  while (random.once_in(2)) {
    vary(frame, modbus, module, random);
  }
  if (modbus) {
    if (!frame.empty() && frame[0] != 0) {
      frame[0] = random.once_in(20)   ? any_byte(random)
                 : random.once_in(12) ? std::uint8_t{0}
                                      : static_cast<std::uint8_t>(module.address());
      if (frame[0] == kScan) {
        ++frame[0];  // the judge does not know rounds of a scan; scan_test does
      }
      if (random.once_in(10)) {
        by_serial_number(frame, random.once_in(10) ? random.below(0x10000) : module.serial_number());
      }
    }
    return with_crc(frame);
  }
  const bool addressed = frame.size() >= 3 && std::isxdigit(frame[1]) != 0 && std::isxdigit(frame[2]) != 0;
  if (addressed) {
    const std::string address = reference::hex(random.once_in(20) ? any_byte(random) : module.address(), 2);
    std::copy(address.begin(), address.end(), frame.begin() + 1);
  }
  if (module.checksum() != random.once_in(20)) {
    const std::string check = reference::check_of(std::string(frame.begin(), frame.end()));
    frame.insert(frame.end(), check.begin(), check.end());
  }
  frame.push_back('\r');
  return frame;
}

}  // namespace ex9000::world
