#include "sim/utility/verify/init_mode.hpp"

#include <algorithm>

#include "sim/text/values.hpp"
#include "sim/utility/modbus/module.hpp"
#include "sim/utility/modbus/register_map.hpp"

namespace ex9000::utility {

namespace {

constexpr hal::SerialMode kMode{9600, LineFormat::k8N1};
constexpr unsigned kByteBits = 8;
constexpr unsigned kOneGroup = 8;  // channels in a byte of `@AA`

constexpr unsigned kNumber = registers_of("serial-number");
constexpr unsigned kFilters = registers_of("input-filters");
constexpr unsigned kInversion = registers_of("inverted-inputs");
constexpr unsigned kFeed = registers_of("watchdog-feed");
constexpr unsigned kDelay = registers_of("response-delay");
constexpr unsigned kUpdates = registers_of("updates-allowed");

/// Hex digits of a reply. `at`: after the lead.
unsigned hex_in(const std::string& reply, std::size_t at, std::size_t digits) {
  const std::string text = reply.size() < at + digits + 1 ? "" : reply.substr(at + 1, digits);
  if (text.empty() || text.find_first_not_of("0123456789ABCDEF") != std::string::npos) {
    throw NotVerified("in INIT mode, the module gives the reply '" + reply + "', which has another form");
  }
  constexpr int kHex = 16;
  return static_cast<unsigned>(std::stoul(text, nullptr, kHex));
}

/// Of a byte or word as in `@AA`: a first byte and a second one.
std::uint16_t channels_in(unsigned word, unsigned channels) {
  return static_cast<std::uint16_t>(channels > kOneGroup ? word : word >> kByteBits);
}

std::string watchdog_command(bool enabled, unsigned timeout) {
  return std::string("~003") + (enabled ? '1' : '0') + sim::hex_byte_text(timeout);
}

/// What `@00` takes.
std::string drive_command(const Model& model, std::uint16_t channels) {
  return "@00" + (model.outputs > kOneGroup ? sim::hex_word_text(channels)
                                            : sim::hex_byte_text(channels).substr(model.outputs > 4 ? 0 : 1));
}

std::string name_text(const Name& name) {
  const Bytes bytes = name.bytes();
  return {bytes.data, bytes.data + bytes.size};
}

/// Null if it is the factory name of no model or of several.
const Model* model_with_name(const std::string& name) {
  const Model* found = nullptr;
  for (const Model& model : kModels) {
    if (model.factory_name == name) {
      if (found != nullptr) {
        return nullptr;
      }
      found = &model;
    }
  }
  return found;
}

}  // namespace

std::vector<std::string> commands_between(const Model& model, const Settings& now, const Settings& wanted) {
  std::vector<std::string> commands;
  const auto put = [&](std::string command) { commands.push_back(std::move(command)); };
  const auto put_word = [&](unsigned address, unsigned was, unsigned value) {
    if (was != value) {
      put("~00X" + sim::hex_word_text(address) + sim::hex_word_text(value));
    }
  };
  Settings then = now;
  if (now.watchdog_enabled && now != wanted) {  // it must not expire meanwhile
    then.watchdog_enabled = false;
    put(watchdog_command(false, now.watchdog_timeout));
  }
  if (now.timeout_status) {  // it blocks the outputs
    put("~001");
  }
  if (now.power_on_value != wanted.power_on_value) {
    put(drive_command(model, wanted.power_on_value));
    put("~005P");
  }
  if (now.safe_value != wanted.safe_value) {
    put(drive_command(model, wanted.safe_value));
    put("~005S");
  }
  if (!(now.name == wanted.name)) {
    put("~00O" + name_text(wanted.name));
  }
  for (unsigned channel = 0; channel < model.inputs; ++channel) {
    put_word(kFilters + channel, now.input_filters.of(channel), wanted.input_filters.of(channel));
  }
  put_word(kInversion, now.inverted_inputs, wanted.inverted_inputs);
  put_word(kFeed, now.fed_by_requests ? 1 : 0, wanted.fed_by_requests ? 1 : 0);
  put_word(kDelay, now.response_delay, wanted.response_delay);
  put_word(kUpdates, now.updates_allowed ? 1 : 0, wanted.updates_allowed ? 1 : 0);
  // An address that Modbus does not have is possible only while the stored protocol is ASCII.
  if (now.protocol != wanted.protocol && wanted.protocol == Protocol::Ascii) {
    put("$00P0");
  }
  if (now.address != wanted.address || now.baud_code != wanted.baud_code || now.format != wanted.format) {
    put("%00" + sim::hex_byte_text(wanted.address) + "40" + sim::hex_byte_text(wanted.baud_code) +
        sim::hex_byte_text(wanted.format));
  }
  if (now.protocol != wanted.protocol && wanted.protocol == Protocol::ModbusRtu) {
    put("$00P1");
  }
  if (then.watchdog_enabled != wanted.watchdog_enabled || now.watchdog_timeout != wanted.watchdog_timeout) {
    put(watchdog_command(wanted.watchdog_enabled, wanted.watchdog_timeout));
  }
  return commands;
}

void InitMode::restart(bool init) {
  constexpr std::size_t kEnableAt = 3;
  rig_.ask("power off");
  has_restarted_ = true;
  rig_.ask(init ? "init on" : "init off");
  rig_.ask("power on");
  line_.connection().pause(kStart);
  if (init) {
    line_.set_mode(kMode);
    line_.dcon().set_checksum(false);
    const std::optional<std::string> watchdog = line_.dcon().ask("~002");
    watchdog_runs_ = watchdog && watchdog->size() > kEnableAt && (*watchdog)[kEnableAt] == '1';
  }
}

/// The host watchdog must not expire while its settings are read.
std::optional<std::string> InitMode::exchange(const std::string& command) {
  if (watchdog_runs_) {
    constexpr std::chrono::milliseconds kSending{5};
    line_.connection().send(dcon_frame("~**", false));
    line_.connection().pause(kSending);
  }
  return line_.dcon().ask(command);
}

std::string InitMode::ask(const std::string& command) {
  constexpr int kTries = 3;
  for (int i = 0; i < kTries; ++i) {
    const std::optional<std::string> reply = exchange(command);
    if (reply && reply->front() == '?') {
      throw NotVerified("in INIT mode, the module refuses '" + command + "'");
    }
    if (reply) {
      return *reply;
    }
  }
  throw NotVerified("in INIT mode, the module gives no reply to '" + command + "'");
}

/// The hex digits; nullopt: the module has no such register.
std::optional<std::string> InitMode::extension(unsigned address) {
  constexpr std::size_t kValueAt = 3;
  const std::optional<std::string> reply = exchange("~00X" + sim::hex_word_text(address));
  return reply && reply->front() == '!' && reply->size() > kValueAt ? std::optional(reply->substr(kValueAt))
                                                                    : std::nullopt;
}

Nameplate InitMode::nameplate() {
  constexpr std::size_t kTextAt = 3;
  const auto text_of = [&](const char* command) {
    const std::string reply = ask(command);
    return reply.substr(std::min(kTextAt, reply.size()));
  };
  Nameplate plate;
  plate.address = static_cast<std::uint8_t>(hex_in(ask("$002"), 0, 2));
  plate.name = text_of("$00M");
  plate.version = text_of("$00F");
  if (const auto number = extension(kNumber)) {
    plate.serial_number = hex_in("!" + *number, 0, number->size());
  }
  plate.model = model_with_name(plate.name);
  return plate;
}

Settings InitMode::read(const Model& model) {
  constexpr unsigned kTimeoutStatus = 0x04;
  constexpr std::size_t kTextAt = 3;
  Settings settings = Settings::factory(model);
  const std::string configuration = ask("$002");
  settings.address = static_cast<std::uint8_t>(hex_in(configuration, 0, 2));
  settings.baud_code = static_cast<std::uint8_t>(hex_in(configuration, 4, 2));
  settings.format = static_cast<std::uint8_t>(hex_in(configuration, 6, 2));
  if (model.speaks_modbus()) {
    settings.protocol = hex_in(ask("$00P"), 2, 2) % 2 == 0 ? Protocol::Ascii : Protocol::ModbusRtu;
  }
  const std::string name = ask("$00M");
  settings.name = Name(std::string_view(name).substr(std::min(kTextAt, name.size())));
  settings.timeout_status = (hex_in(ask("~000"), 2, 2) & kTimeoutStatus) != 0;
  const std::string watchdog = ask("~002");
  settings.watchdog_enabled = hex_in(watchdog, 2, 1) != 0;
  settings.watchdog_timeout = static_cast<std::uint8_t>(hex_in(watchdog, 3, 2));
  if (model.has_outputs()) {
    settings.power_on_value = channels_in(hex_in(ask("~004P"), 2, 4), model.outputs);
    settings.safe_value = channels_in(hex_in(ask("~004S"), 2, 4), model.outputs);
  }
  const auto word = [&](unsigned address, unsigned otherwise) {
    const std::optional<std::string> digits = extension(address);
    return digits ? hex_in("!" + *digits, 0, 4) : otherwise;
  };
  for (unsigned channel = 0; channel < model.inputs; ++channel) {
    settings.input_filters.set(channel, static_cast<std::uint16_t>(word(kFilters + channel, 0)));
  }
  settings.inverted_inputs = static_cast<std::uint16_t>(model.has_inputs() ? word(kInversion, 0) : 0);
  settings.fed_by_requests = word(kFeed, 0) != 0;
  settings.response_delay = static_cast<std::uint8_t>(word(kDelay, 0));
  settings.updates_allowed = word(kUpdates, settings.updates_allowed ? 1 : 0) != 0;
  const std::optional<std::string> number = extension(kNumber);
  settings.serial_number = number ? hex_in("!" + *number, 0, number->size()) : 0;
  return settings;
}

void InitMode::write(const Model& model, const Settings& wanted) {
  if (read(model).serial_number != wanted.serial_number) {
    write_serial_number(model, wanted.serial_number);
  }
  write_all_but_serial_number(model, wanted);
}

void InitMode::write_all_but_serial_number(const Model& model, const Settings& wanted) {
  Settings settings = wanted;
  settings.timeout_status = false;
  settings.watchdog_enabled = wanted.watchdog_enabled && !wanted.timeout_status;
  for (const std::string& command : commands_between(model, read(model), settings)) {
    ask(command);
  }
  watchdog_runs_ = settings.watchdog_enabled;
  if (wanted.timeout_status) {  // only an expiry sets it
    constexpr std::chrono::milliseconds kExpiry{300};
    ask(watchdog_command(true, 1));
    line_.connection().pause(kExpiry);
    ask(watchdog_command(wanted.watchdog_enabled, wanted.watchdog_timeout));
  }
}

void InitMode::write_serial_number(const Model& model, std::uint32_t wanted) {
  Settings settings = Settings::factory(model);
  write_all_but_serial_number(model, settings);
  leave();
  line_.set_mode({baud_rate(settings.baud_code), line_format(settings.baud_code)});
  Module module(line_.modbus(), at_address(settings.address));
  const auto number = [&] {
    const Answer answer = module.ask(read_words(kNumber, 2));
    return answer.refused() ? 0 : Bytes{answer.data.data(), answer.data.size()}.double_word(0);
  };
  const auto store = [&](std::uint32_t value) {
    Data data;
    append_word(data, value >> (2 * kByteBits));
    append_word(data, value & 0xFFFFU);
    module.ask(write_words(kNumber, {data.data(), data.size()}));
  };
  store(0);  // that of the board, which the module probably had
  if (number() != wanted) {
    store(wanted);
  }
  enter();
}

bool InitMode::inputs_are_off(const Model& model) {
  const unsigned word = hex_in(ask("@00"), 0, 4);
  constexpr unsigned kSecond = 0xFF;
  return (model.has_outputs() ? word & kSecond : unsigned{channels_in(word, model.inputs)}) == 0;
}

Time InitMode::latency() {
  constexpr int kRoundTrips = 10;
  const Data request = dcon_frame("$00M", false);
  Connection& connection = line_.connection();
  Time shortest = DconMaster::kPatience;
  for (int i = 0; i < kRoundTrips; ++i) {
    connection.pause(std::chrono::milliseconds(2));
    const Time begin = connection.now();
    connection.send(request);
    Data reply;
    while (reply.empty() || reply.back() != '\r') {
      const Data more = connection.receive(DconMaster::kPatience);
      if (more.empty()) {
        break;
      }
      reply.insert(reply.end(), more.begin(), more.end());
    }
    if (reply == request) {
      throw NotVerified("the port receives what it sends; switch this off, or use another adapter");
    }
    // A module waits for one character.
    const Time took = connection.now() - begin - time_of(request.size() + 1 + reply.size(), kMode);
    shortest = reply.empty() ? shortest : std::min(shortest, std::max(took, Time(0)));
  }
  return shortest;
}

}  // namespace ex9000::utility
