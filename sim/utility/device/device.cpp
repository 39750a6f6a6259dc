#include "sim/utility/device/device.hpp"

#include <algorithm>

#include "sim/text/values.hpp"

namespace ex9000::utility {

namespace {

constexpr std::uint8_t kIllegalFunction = 1;
constexpr std::uint8_t kIllegalAddress = 2;

std::string with_address(std::string text, std::uint8_t address) {
  const std::size_t at = text.find("AA");
  return at == std::string::npos ? text : text.replace(at, 2, sim::hex_byte_text(address));
}

}  // namespace

std::uint32_t hex_number(const std::string& digits) {
  constexpr std::size_t kMost = 8;
  if (digits.empty() || digits.size() > kMost ||
      digits.find_first_not_of("0123456789ABCDEF") != std::string::npos) {
    throw Failed("replies '" + digits + "' where hex digits are expected");
  }
  constexpr int kHex = 16;
  return static_cast<std::uint32_t>(std::stoul(digits, nullptr, kHex));
}

Device Device::in_modbus(MasterLine& line, const Addressee& to) {
  Device device(line);
  device.name_ = to.name;
  device.module_.emplace(line.modbus(), to);
  return device;
}

Device Device::in_ascii(MasterLine& line, std::uint8_t address) {
  Device device(line);
  device.moves_to(address);
  device.checksum_ = line.dcon().checksum();
  return device;
}

void Device::moves_to(std::uint8_t address) {
  address_ = address;
  name_ = std::to_string(address);
}

Answer Device::read(const Request& request) {
  Answer answer = module_->ask(request, patience_.value_or(Module::kPatience));
  if (answer.exception == kIllegalFunction || answer.exception == kIllegalAddress) {
    throw Absent("does not have this: " + exception_text(answer.exception));
  }
  if (answer.refused()) {
    throw Failed("refuses the request: " + exception_text(answer.exception));
  }
  return answer;
}

void Device::write(const Request& request) { read(request); }

std::string Device::ask(const std::string& command, const std::string& reply) {
  constexpr unsigned kTries = 4;
  const std::string request = with_address(command, address_);
  const std::string expected = with_address(reply, address_);
  line_->dcon().set_checksum(checksum_);
  const Time patience = patience_.value_or(DconMaster::kPatience);
  const Time began = line_->connection().now();
  unsigned refusals = 0;
  for (unsigned i = 0; i < kTries; ++i) {
    const std::optional<std::string> text = line_->dcon().ask(request, patience);
    if (text && i != 0) {
      line_->connection().drop_late_replies(began);
    }
    if (text && (*text == "?" || text->compare(0, 3, "?" + sim::hex_byte_text(address_)) == 0)) {
      if (++refusals == 2) {  // the first one may refuse what noise has made of the request
        throw Absent("refuses " + request);
      }
      continue;
    }
    if (text && *text == "!" && reply != "!") {
      throw Failed("ignores " + request + ", because its host watchdog has timed out; send ~AA1 first");
    }
    if (text && text->compare(0, expected.size(), expected) == 0) {
      return text->substr(expected.size());
    }
  }
  throw Failed("gives no reply to " + request + "; check address, rate, format, checksum and wires");
}

unsigned Device::extension(unsigned address) {
  if (speaks_modbus()) {
    return read(read_words(address, 1)).word(0);
  }
  return hex_number(ask("~AAX" + sim::hex_word_text(address)));
}

std::uint32_t Device::long_extension(unsigned address) {
  if (speaks_modbus()) {
    const Answer answer = read(read_words(address, 2));
    return Bytes{answer.data.data(), answer.data.size()}.double_word(0);
  }
  return hex_number(ask("~AAX" + sim::hex_word_text(address)));
}

void Device::write_extension(unsigned address, unsigned value) {
  if (speaks_modbus()) {
    write(write_word(address, static_cast<std::uint16_t>(value)));
  } else {
    ask("~AAX" + sim::hex_word_text(address) + sim::hex_word_text(value));
  }
}

}  // namespace ex9000::utility
