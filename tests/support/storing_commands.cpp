#include "tests/support/storing_commands.hpp"

#include "tests/oracles/reference/hexadecimal.hpp"

namespace ex9000 {

namespace {

using Bytes = std::vector<std::uint8_t>;

/// Returns the last two hex digits of `value`.
std::string hex(unsigned value) { return reference::hex(value, 2); }

Bytes text(const std::string& characters) { return {characters.begin(), characters.end()}; }

/// Returns the part NNTTCCFF of the command `%AANNTTCCFF`.
std::string configuration(unsigned address, unsigned baud_code, unsigned format) {
  return hex(address) + "40" + hex(baud_code) + hex(format);
}

/// Returns a code other than `code`.
std::uint8_t other_baud_code(std::uint8_t code) { return code == kFactoryBaudCode ? 0x4A : kFactoryBaudCode; }

constexpr std::uint8_t kNewAddress = 0x2B;
constexpr std::uint8_t kNewTimeout = 0x64;
// 0.5 s. At 9600 baud or more, a master can read all settings of a model with up to 8 inputs in this time,
// even with a response delay of kNewDelay.
constexpr std::uint8_t kShortTimeout = 0x05;
constexpr std::uint8_t kNewDelay = 2;
constexpr std::uint16_t kNewValue = 0x3C96;
constexpr std::uint16_t kOneBit = 1U << 0U;

void needs_nothing(Settings& /*settings*/) {}
void needs_clear_status(Settings& settings) { settings.timeout_status = false; }
void needs_status(Settings& settings) { settings.timeout_status = true; }
void needs_a_delay(Settings& settings) { settings.response_delay = 1; }
void needs_disabled(Settings& settings) { settings.watchdog_enabled = false; }
void needs_enabled(Settings& settings) { settings.watchdog_enabled = true; }
void needs_a_short_timeout(Settings& settings) {
  settings.timeout_status = false;
  settings.watchdog_enabled = true;
  settings.watchdog_timeout = kShortTimeout;
}

using Change = std::function<void(Settings&, std::uint16_t)>;

std::vector<StoringCommand> ascii_commands(const Model& model) {
  std::vector<StoringCommand> commands;
  const auto add = [&](const std::string& name, Init init, std::function<void(Settings&)> prepare,
                       std::function<std::string(const Settings&)> rest, Change change) {
    // In INIT mode, the module has the address 00.
    auto frame = [name, rest = std::move(rest), init](const Settings& settings) {
      return text(name.substr(0, 1) + hex(init == Init::SinceReset ? 0 : settings.address) + rest(settings));
    };
    commands.push_back({name, Protocol::Ascii, init, std::move(prepare), std::move(frame), std::move(change),
                        nullptr, true});
  };
  const auto always = [](const char* rest) { return [rest](const Settings& /*settings*/) { return rest; }; };
  add(
      "% address", Init::Released, needs_nothing,
      [](const Settings& now) { return configuration(kNewAddress, now.baud_code, now.format); },
      [](Settings& settings, std::uint16_t) { settings.address = kNewAddress; });
  add(
      "% edge", Init::Released, needs_nothing,
      [](const Settings& now) {
        return configuration(now.address, now.baud_code, now.format ^ kFormatRisingEdge);
      },
      [](Settings& settings, std::uint16_t) { settings.format ^= kFormatRisingEdge; });
  for (const Init init : {Init::Tied, Init::SinceReset}) {
    const std::string where = init == Init::Tied ? " with INIT*" : " in INIT mode";
    add(
        "% all" + where, init, needs_nothing,
        [](const Settings& now) {
          return configuration(kNewAddress, other_baud_code(now.baud_code), now.format ^ kFormatMask);
        },
        [](Settings& settings, std::uint16_t) {
          settings.address = kNewAddress;
          settings.baud_code = other_baud_code(settings.baud_code);
          settings.format ^= kFormatMask;
        });
    add(
        "$AAPN" + where, init, needs_nothing,
        [](const Settings& now) { return now.protocol == Protocol::Ascii ? "P1" : "P0"; },
        [](Settings& settings, std::uint16_t) {
          settings.protocol = settings.protocol == Protocol::Ascii ? Protocol::ModbusRtu : Protocol::Ascii;
        });
  }
  for (const Init init : {Init::Released, Init::SinceReset}) {
    const std::string where = init == Init::Released ? "" : " in INIT mode";
    add("~AAO" + where, init, needs_nothing, always("OValve7"),
        [](Settings& settings, std::uint16_t) { settings.name = Name(std::string_view("Valve7")); });
    add("~AA31VV" + where, init, needs_nothing, always("3164"), [](Settings& settings, std::uint16_t) {
      settings.watchdog_enabled = true;
      settings.watchdog_timeout = kNewTimeout;
    });
    add("~AA30VV" + where, init, needs_nothing, always("3033"), [](Settings& settings, std::uint16_t) {
      settings.watchdog_enabled = false;
      settings.watchdog_timeout = 0x33;
    });
    add("~AA1" + where, init, needs_status, always("1"),
        [](Settings& settings, std::uint16_t) { settings.timeout_status = false; });
    add("~AARDVV" + where, init, needs_nothing, always("RD02"),
        [](Settings& settings, std::uint16_t) { settings.response_delay = kNewDelay; });
    if (model.outputs != 0) {
      add("~AA5P" + where, init, needs_nothing, always("5P"),
          [](Settings& settings, std::uint16_t outputs) { settings.power_on_value = outputs; });
      add("~AA5S" + where, init, needs_clear_status, always("5S"),
          [](Settings& settings, std::uint16_t outputs) { settings.safe_value = outputs; });
    }
  }
  return commands;
}

std::vector<StoringCommand> modbus_commands(const Model& model) {
  std::vector<StoringCommand> commands;
  const auto add = [&](const std::string& name, std::function<void(Settings&)> prepare, const Bytes& rest,
                       Change change) {
    const bool broadcast = name.rfind("broadcast", 0) == 0;
    commands.push_back({name, Protocol::ModbusRtu, Init::Released, std::move(prepare),
                        [rest, broadcast](const Settings& settings) {
                          Bytes frame = rest;
                          frame.insert(frame.begin(), broadcast ? std::uint8_t{0} : settings.address);
                          return frame;
                        },
                        std::move(change), nullptr, !broadcast});
  };
  const Change take_address = [](Settings& settings, std::uint16_t) { settings.address = kNewAddress; };
  add("05 protocol", needs_nothing, {0x05, 0x01, 0x00, 0x00, 0x00},
      [](Settings& settings, std::uint16_t) { settings.protocol = Protocol::Ascii; });
  // The module also executes these requests as broadcasts. A broadcast never changes the protocol, the
  // counting edge, the address or the baud rate (wire.md section 7), or an extension register that is stored
  // (firmware/extensions.md).
  for (const std::string to : {"", "broadcast "}) {
    add(to + "05 watchdog on", needs_disabled, {0x05, 0x01, 0x04, 0xFF, 0x00},
        [](Settings& settings, std::uint16_t) { settings.watchdog_enabled = true; });
    add(to + "05 watchdog off", needs_enabled, {0x05, 0x01, 0x04, 0x00, 0x00},
        [](Settings& settings, std::uint16_t) { settings.watchdog_enabled = false; });
    add(to + "05 timeout status", needs_status, {0x05, 0x01, 0x0D, 0xFF, 0x00},
        [](Settings& settings, std::uint16_t) { settings.timeout_status = false; });
    add(to + "06 timeout", needs_nothing, {0x06, 0x01, 0xE8, 0x00, kNewTimeout},
        [](Settings& settings, std::uint16_t) { settings.watchdog_timeout = kNewTimeout; });
    add(to + "10 timeout", needs_nothing, {0x10, 0x01, 0xE8, 0x00, 0x01, 0x02, 0x00, kNewTimeout},
        [](Settings& settings, std::uint16_t) { settings.watchdog_timeout = kNewTimeout; });
  }
  add("06 address", needs_nothing, {0x06, 0x01, 0xE4, 0x00, kNewAddress}, take_address);
  add("46 address", needs_nothing, {0x46, 0x04, kNewAddress, 0x00, 0x00, 0x00}, take_address);
  add("06 rate and line format", needs_nothing, {0x06, 0x01, 0xE5, 0x00, 0xC8},
      [](Settings& settings, std::uint16_t) { settings.baud_code = 0xC8; });
  add("10 address and rate", needs_nothing,
      {0x10, 0x01, 0xE4, 0x00, 0x02, 0x04, 0x00, kNewAddress, 0x00, 0x08},
      [](Settings& settings, std::uint16_t) {
        settings.address = kNewAddress;
        settings.baud_code = 0x08;
      });
  add("06 address in force", needs_nothing, {0x06, 0x00, 0x80, 0x00, kNewAddress}, take_address);
  add("10 serial number", needs_nothing, {0x10, 0x01, 0x0E, 0x00, 0x02, 0x04, 0x0D, 0x00, 0x3C, 0x96},
      [](Settings& settings, std::uint16_t) { settings.serial_number = 0x0D003C96; });
  add("06 response delay", needs_nothing, {0x06, 0x02, 0x52, 0x00, kNewDelay},
      [](Settings& settings, std::uint16_t) { settings.response_delay = kNewDelay; });
  add("06 no response delay", needs_a_delay, {0x06, 0x02, 0x52, 0x00, 0x00},
      [](Settings& settings, std::uint16_t) { settings.response_delay = 0; });
  add("06 watchdog feed", needs_nothing, {0x06, 0x02, 0x51, 0x00, 0x01},
      [](Settings& settings, std::uint16_t) { settings.fed_by_requests = true; });
  if (model.inputs != 0) {
    add("10 filters", needs_nothing, {0x10, 0x02, 0x40, 0x00, 0x02, 0x04, 0x00, 0x05, 0x07, 0xD0},
        [](Settings& settings, std::uint16_t) {
          settings.input_filters.set(0, 5);
          settings.input_filters.set(1, 2000);
        });
    add("06 inversion", needs_nothing, {0x06, 0x02, 0x50, 0x00, 0x81},
        [](Settings& settings, std::uint16_t) { settings.inverted_inputs = 0x81; });
    add(
        "05 counting edge",
        [](Settings& settings) {
          settings.format = static_cast<std::uint8_t>(settings.format & ~kFormatRisingEdge);
        },
        {0x05, 0x08, 0xCA, 0xFF, 0x00},
        [](Settings& settings, std::uint16_t) { settings.format |= kFormatRisingEdge; });
  }
  if (model.outputs == 0) {
    return commands;
  }
  constexpr std::uint8_t kSafe = 0x80;
  constexpr std::uint8_t kPowerOn = 0xA0;
  for (const std::uint8_t row : {kSafe, kPowerOn}) {
    const auto value_of = [row](Settings& settings) -> std::uint16_t& {
      return row == kSafe ? settings.safe_value : settings.power_on_value;
    };
    const std::string what = row == kSafe ? "safe value" : "power-on value";
    const Change all = [value_of](Settings& settings, std::uint16_t) { value_of(settings) = kNewValue; };
    const auto drive_all = [](const Settings&, std::uint16_t) { return kNewValue; };
    const Bytes write_all{0x0F, 0x00, row, 0x00, 0x10, 0x02, kNewValue & 0xFFU, kNewValue >> 8U};
    for (const std::string to : {"", "broadcast "}) {
      add(to + "05 one bit of the " + what, needs_clear_status, {0x05, 0x00, row, 0xFF, 0x00},
          [value_of](Settings& settings, std::uint16_t) {
            value_of(settings) = static_cast<std::uint16_t>(value_of(settings) | kOneBit);
          });
      commands.back().drive = [](const Settings&, std::uint16_t outputs) {
        return static_cast<std::uint16_t>(outputs | kOneBit);
      };
      add(to + "0F " + what, needs_clear_status, write_all, all);
      commands.back().drive = drive_all;
    }
  }
  return commands;
}

}  // namespace

bool StoringCommand::stores_from(const Settings& settings, std::uint16_t outputs) const {
  Settings prepared = settings;
  prepare(prepared);
  return prepared == settings && done_to(settings, outputs) != settings;
}

std::vector<StoringCommand> storing_commands(const Model& model) {
  std::vector<StoringCommand> commands = ascii_commands(model);
  const std::vector<StoringCommand> modbus = modbus_commands(model);
  commands.insert(commands.end(), modbus.begin(), modbus.end());
  for (const Protocol protocol : {Protocol::Ascii, Protocol::ModbusRtu}) {
    commands.push_back({protocol == Protocol::Ascii ? "timeout, ASCII" : "timeout, Modbus", protocol,
                        Init::Released, needs_a_short_timeout, nullptr,
                        [](Settings& settings, std::uint16_t) {
                          settings.timeout_status = true;
                          settings.watchdog_enabled = false;
                        },
                        [](const Settings& done, std::uint16_t) { return done.safe_value; }, false});
  }
  return commands;
}

std::vector<std::uint8_t> ascii_frame(const std::string& text, bool checksum) {
  unsigned sum = 0;
  for (const char character : text) {
    sum += static_cast<unsigned char>(character);
  }
  const std::string frame = text + (checksum ? hex(sum) : "") + "\r";
  return {frame.begin(), frame.end()};
}

}  // namespace ex9000
