#include "tests/support/settings_reader.hpp"

#include <gtest/gtest.h>

#include "sim/app/play/modbus_frame.hpp"
#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/support/storing_commands.hpp"

namespace ex9000 {

namespace {

// The extension registers that contain settings: firmware/extensions.md.
constexpr unsigned kFilters = 0x0240;
constexpr unsigned kInversion = 0x0250;
constexpr unsigned kFeed = 0x0251;
constexpr unsigned kDelay = 0x0252;
constexpr unsigned kSerialNumber = 0x010E;

std::uint16_t word(const std::vector<std::uint8_t>& reply, std::size_t at) {
  return static_cast<std::uint16_t>(reply.at(at) << 8U | reply.at(at + 1));
}

}  // namespace

std::uint8_t hex_byte(const std::string& text, std::size_t at) {
  return static_cast<std::uint8_t>(std::stoul(text.substr(at, 2), nullptr, 16));
}

std::vector<std::uint8_t> FrameFormat::framed(const std::vector<std::uint8_t>& request) const {
  return protocol == Protocol::Ascii ? ascii_frame({request.begin(), request.end()}, checksum)
                                     : with_crc(request);
}

std::optional<Settings> SettingsReader::read(std::uint8_t format) {
  return frame_format_.protocol == Protocol::Ascii ? read_ascii() : read_modbus(format);
}

SettingsReader::Bytes SettingsReader::ask(const Bytes& request) {
  Bytes frame = request;
  frame.insert(frame.begin(), frame_format_.address);
  const Bytes reply = exchange_(frame_format_.framed(frame));
  if (reply.size() < 4) {
    return {};
  }
  const Bytes body(reply.begin(), reply.end() - 2);
  EXPECT_EQ(with_crc(body), reply);
  return body;
}

std::string SettingsReader::ask(const std::string& command) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  const std::string text = command.substr(0, 1) + kDigits[frame_format_.address / 16] +
                           kDigits[frame_format_.address % 16] + command.substr(1);
  const Bytes reply = exchange_(frame_format_.framed({text.begin(), text.end()}));
  const std::size_t frame = frame_format_.checksum ? 3 : 1;
  if (reply.size() <= frame) {
    return {};
  }
  const std::string body(reply.begin(), reply.end() - static_cast<std::ptrdiff_t>(frame));
  EXPECT_EQ(ascii_frame(body, frame_format_.checksum), reply);
  return body;
}

std::optional<Settings> SettingsReader::read_ascii() {
  const std::string configuration = ask(std::string("$2"));
  if (configuration.size() != 9) {
    return std::nullopt;
  }
  Settings settings;
  settings.updates_allowed = true;  // no storing command changes it
  settings.address = hex_byte(configuration, 1);
  settings.baud_code = hex_byte(configuration, 5);
  settings.format = hex_byte(configuration, 7);
  const bool modbus = model_.speaks_modbus() && ask(std::string("$P")).at(4) == '1';
  settings.protocol = modbus ? Protocol::ModbusRtu : Protocol::Ascii;
  settings.name = Name(std::string_view(ask(std::string("$M")).substr(3)));
  settings.timeout_status = (hex_byte(ask(std::string("~0")), 3) & 0x04U) != 0;
  const std::string watchdog = ask(std::string("~2"));
  settings.watchdog_enabled = watchdog.at(3) == '1';
  settings.watchdog_timeout = hex_byte(watchdog, 4);
  if (model_.outputs != 0) {
    const auto value = [&](const char* command) {
      const std::string reply = ask(std::string(command));
      // `first` contains the outputs from output 8 if the model has them; otherwise, outputs 0 to 7.
      const unsigned first = hex_byte(reply, 3);
      const bool has_two_groups = model_.outputs > 8;
      return static_cast<std::uint16_t>(has_two_groups ? first << 8U | hex_byte(reply, 5) : first);
    };
    settings.power_on_value = value("~4P");
    settings.safe_value = value("~4S");
  }
  const auto extension = [&](unsigned address) {
    const std::string reply = ask("~X" + reference::hex(address, 4));
    return static_cast<std::uint16_t>(hex_byte(reply, 3) << 8U | hex_byte(reply, 5));
  };
  for (unsigned channel = 0; channel < model_.inputs; ++channel) {
    settings.input_filters.set(channel, extension(kFilters + channel));
  }
  settings.inverted_inputs = model_.inputs != 0 ? extension(kInversion) : std::uint16_t{0};
  settings.fed_by_requests = extension(kFeed) != 0;
  settings.response_delay = static_cast<std::uint8_t>(extension(kDelay));
  const std::string number = ask("~X" + reference::hex(kSerialNumber, 4)).substr(3);
  settings.serial_number = stored(static_cast<std::uint32_t>(std::stoul(number, nullptr, 16)));
  return settings;
}

std::optional<Settings> SettingsReader::read_modbus(std::uint8_t format) {
  const auto registers = [&](std::uint8_t low, std::uint8_t count) {
    return ask(Bytes{0x03, 0x01, low, 0x00, count});
  };
  const auto coil = [&](std::uint8_t low) { return ask(Bytes{0x01, 0x01, low, 0x00, 0x01}).at(3) == 1; };
  const Bytes address_and_rate = registers(0xE4, 2);
  if (address_and_rate.size() != 7) {
    return std::nullopt;
  }
  Settings settings;
  settings.updates_allowed = true;  // no storing command changes it
  settings.address = static_cast<std::uint8_t>(word(address_and_rate, 3));
  settings.baud_code = static_cast<std::uint8_t>(word(address_and_rate, 5));
  settings.format = format;
  settings.protocol = coil(0x00) ? Protocol::ModbusRtu : Protocol::Ascii;
  settings.watchdog_timeout = static_cast<std::uint8_t>(word(registers(0xE8, 1), 3));
  settings.watchdog_enabled = coil(0x04);
  settings.timeout_status = coil(0x0D);
  const Bytes identification = ask(Bytes{0x11});
  // substr throws std::out_of_range if the reply is too short.
  settings.name = Name(std::string(identification.begin(), identification.end()).substr(6));
  if (model_.outputs != 0) {
    const auto value = [&](std::uint8_t row) {
      const Bytes reply = ask(Bytes{0x01, 0x00, row, 0x00, static_cast<std::uint8_t>(model_.outputs)});
      return static_cast<std::uint16_t>(reply.at(3) | (model_.outputs > 8 ? reply.at(4) << 8U : 0));
    };
    settings.safe_value = value(0x80);
    settings.power_on_value = value(0xA0);
  }
  const auto extension = [&](unsigned address) {
    return word(ask(Bytes{0x03, static_cast<std::uint8_t>(address >> 8U), static_cast<std::uint8_t>(address),
                          0x00, 0x01}),
                3);
  };
  for (unsigned channel = 0; channel < model_.inputs; ++channel) {
    settings.input_filters.set(channel, extension(kFilters + channel));
  }
  settings.inverted_inputs = model_.inputs != 0 ? extension(kInversion) : std::uint16_t{0};
  settings.fed_by_requests = extension(kFeed) != 0;
  settings.response_delay = static_cast<std::uint8_t>(extension(kDelay));
  const Bytes number = ask(Bytes{0x03, 0x01, 0x0E, 0x00, 0x02});
  settings.serial_number = stored(std::uint32_t{word(number, 3)} << 16U | word(number, 5));
  return settings;
}

}  // namespace ex9000
