#include <algorithm>
#include <array>
#include <iomanip>
#include <sstream>

#include "firmware/model/baud.hpp"
#include "sim/app/model_exports/formats.hpp"
#include "sim/app/model_exports/register_map.hpp"
#include "sim/app/model_exports/shown.hpp"
#include "sim/app/model_exports/yaml.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

using Json = nlohmann::ordered_json;

// The polling intervals, and the timeout of a request. Home Assistant warns about polling intervals shorter
// than 5 s. If a polling interval is not longer than the timeout, Home Assistant shortens the timeout.
constexpr unsigned kOftenSeconds = 5;
constexpr unsigned kSeldomSeconds = 30;
constexpr unsigned kTimeoutSeconds = 2;
/// The silence between two frames, 3.5 characters of 11 bits, takes 32.1 ms at 1200 baud.
constexpr unsigned kWaitMilliseconds = 33;

/// The values of input_type, in the order of the enumeration Table.
constexpr std::array<const char*, 4> kInputTypes{"coil", "discrete_input", "input", "holding"};

class Hub {
 public:
  Hub(const Model& model, const NetworkAddress& network_address)
      : model_(model),
        network_address_(network_address),
        key_(model_key(model) + "_" + hex_byte_text(network_address.address)) {}

  [[nodiscard]] Json hub() const {
    Json hub{{"name", key_},
             {"type", network_address_.modbus_tcp ? "tcp" : "rtuovertcp"},
             {"host", network_address_.tcp.host},
             {"port", network_address_.tcp.port},
             {"timeout", kTimeoutSeconds},
             {"message_wait_milliseconds", kWaitMilliseconds}};
    for (const Shown& shown : shown_by(model_)) {
      add(shown, hub);
    }
    return hub;
  }

  /// Returns the actions that enable the host watchdog and let polls restart it, and the actions to call
  /// after a timeout.
  [[nodiscard]] std::string watchdog_actions() const {
    const std::string after =
        model_.outputs == 0 ? "the timeout status stays set" : "the module refuses to switch the outputs";
    return "# If register 0x0251 is 1, each poll of this module restarts the host watchdog. If the polls\n"
           "# stop for longer than the timeout in register 0x01E8 (factory setting: 25.5 s), the host\n"
           "# watchdog expires. The timeout must be longer than the shortest scan_interval. Polls of any\n"
           "# other master also restart the host watchdog. Call these actions once:\n" +
           write("register", "watchdog-feed", "value: 1") + write("coil", "watchdog-enable", "state: true") +
           "# After a timeout of the host watchdog, " + after + " until you call these actions:\n" +
           write("coil", "timeout-status", "state: true") + write("coil", "watchdog-enable", "state: true");
  }

  /// Returns actions for the items with the role Button, because these items have no entity. Automations and
  /// dashboards can call the actions.
  [[nodiscard]] std::string actions() const {
    std::string text;
    for (const Shown& shown : shown_by(model_)) {
      for (unsigned index = 0; shown.role == Role::Button && index < shown.width; ++index) {
        text += "#   " + shown.name_of(index) + ": " + action("coil", shown.first + index, "state: true");
      }
    }
    return text;
  }

 private:
  /// Returns a call of an action that writes the coil or the register at `address`.
  [[nodiscard]] std::string action(const std::string& kind, unsigned address,
                                   const std::string& value) const {
    return "modbus.write_" + kind + " with hub: " + key_ +
           ", slave: " + std::to_string(network_address_.address) + ", address: " + std::to_string(address) +
           ", " + value + "\n";
  }

  /// Returns a call of an action that writes the item `id` of the register map.
  [[nodiscard]] std::string write(const std::string& kind, std::string_view id,
                                  const std::string& value) const {
    const std::vector<MapRow> map = register_map(model_);
    const auto row = std::find_if(map.begin(), map.end(), [id](const MapRow& each) { return each.id == id; });
    return "#   " + action(kind, row->first, value);
  }

  [[nodiscard]] Json entity(const std::string& name, const std::string& key, unsigned address,
                            unsigned seconds) const {
    return {{"name",
             std::string(model_.designation) + " " + hex_byte_text(network_address_.address) + " " + name},
            {"unique_id", key_ + "_" + key},
            {"slave", network_address_.address},
            {"address", address},
            {"scan_interval", seconds}};
  }

  /// Adds one entity for each output.
  void add_switches(const Shown& shown, Json& hub) const {
    for (unsigned index = 0; index < shown.width; ++index) {
      const unsigned address = shown.first + index;
      Json entity = this->entity(shown.name_of(index), shown.key_of(index), address, kOftenSeconds);
      // Without `verify`, the switch would show the last command, even after a timeout of the host watchdog
      // or a write by another master.
      entity.update({{"write_type", "coil"}, {"verify", {{"input_type", "coil"}, {"address", address}}}});
      hub["switches"].push_back(entity);
    }
  }

  /// Adds a row to the lists of its platform. Items with the roles Preset and Button have no entity: a
  /// dashboard should not change the presets, and the integration has no buttons.
  ///
  /// The integration reads a row of sensors or binary sensors with one request if an entity has the key
  /// virtual_count, which is the number of further entities. It has no such key for switches. It appends 1, 2
  /// and so on to the name and to the unique_id of the further entities.
  void add(const Shown& shown, Json& hub) const {
    const auto add_to = [&](const char* platform, unsigned seconds, const Json& more) {
      Json entity = this->entity(std::string(shown.name), shown.key(), shown.first, seconds);
      if (shown.width > 1) {
        entity["virtual_count"] = shown.width - 1;
      }
      entity.update(more);
      hub[platform].push_back(entity);
    };
    const Json input_type = kInputTypes[static_cast<std::size_t>(shown.table)];
    switch (shown.role) {
      case Role::Output:
        add_switches(shown, hub);
        break;
      case Role::Input:
        add_to("binary_sensors", kOftenSeconds, {{"input_type", input_type}});
        break;
      case Role::State:
        add_to("binary_sensors", kSeldomSeconds, {{"input_type", input_type}});
        break;
      case Role::Problem:
        add_to("binary_sensors", kSeldomSeconds, {{"input_type", input_type}, {"device_class", "problem"}});
        break;
      case Role::Counter:
        add_to("sensors", kOftenSeconds,
               {{"input_type", input_type}, {"data_type", "uint16"}, {"state_class", "total_increasing"}});
        break;
      case Role::Tenths:
        add_to("sensors", kSeldomSeconds,
               {{"input_type", input_type},
                {"data_type", "uint16"},
                {"scale", 0.1},
                {"precision", 1},
                {"device_class", "duration"},
                {"unit_of_measurement", "s"}});
        break;
      case Role::Preset:
      case Role::Button:
        break;
    }
  }

  const Model& model_;
  const NetworkAddress& network_address_;
  std::string key_;
};

/// Returns the number of bytes of the request that polls an entity, and of its reply.
std::size_t bytes_of_poll(const Json& entity) {
  constexpr std::size_t kRequest = 8;
  constexpr std::size_t kReplyWithoutData = 5;
  const std::size_t count = 1 + entity.value("virtual_count", 0U);
  const bool registers = entity.contains("data_type");
  return kRequest + kReplyWithoutData + (registers ? 2 * count : (count + 7) / 8);
}

/// Returns the number and the duration of the requests that poll the entities with this scan_interval, as a
/// text. A poll takes its bytes, the silence before the reply, and the wait of Home Assistant.
std::string round_of(const Json& hub, unsigned interval) {
  constexpr unsigned kCharacterBits = bits_of_character(LineFormat::k8N1);
  constexpr unsigned kSilenceBits = 39;  // 3.5 characters of 11 bits
  unsigned requests = 0;
  std::size_t bits = 0;
  for (const char* platform : {"switches", "binary_sensors", "sensors"}) {
    for (const Json& entity : hub.value(platform, Json::array())) {
      if (entity["scan_interval"] == interval) {
        ++requests;
        bits += bytes_of_poll(entity) * kCharacterBits + kSilenceBits;
      }
    }
  }
  const std::size_t milliseconds =
      bits * 1000 / baud_rate(kFactoryBaudCode) + 1 + std::size_t{requests} * kWaitMilliseconds;
  std::ostringstream seconds;
  seconds << std::fixed << std::setprecision(2) << static_cast<double>(milliseconds) / 1000;
  return std::to_string(requests) + " requests every " + std::to_string(interval) + " s take " +
         seconds.str() + " s";
}

std::string polls(const Model& model, const Json& hub) {
  return "# At " + std::to_string(baud_rate(kFactoryBaudCode)) + " baud, the " +
         round_of(hub, kOftenSeconds) + ", and the " + round_of(hub, kSeldomSeconds) +
         ". The sum for all modules of the hub must be less than " + std::to_string(kOftenSeconds) + " s.\n" +
         (model.inputs == 0 ? ""
                            : "# With virtual_count, one request reads all channels. The entity without a "
                              "number is channel 0.\n") +
         (model.outputs == 0 ? "" : "# Home Assistant reads each switch with its own request.\n");
}

std::string head(const Model& model, const NetworkAddress& network_address) {
  return "# " + std::string(model.designation) + " at address " + hex_byte_text(network_address.address) +
         ", for Home Assistant's modbus integration. In configuration.yaml:\n"
         "#   modbus: !include modbus.yaml\n"
         "# Add further modules of the same RS-485 line to this hub, because Home Assistant does not load a "
         "second hub with the same host and port.\n"
         "# For modules on a serial port, write these keys of the hub in place of type, host and port:\n"
         "#   type: serial\n"
         "#   port: /dev/ttyUSB0\n"
         "#   baudrate: " +
         std::to_string(baud_rate(kFactoryBaudCode)) +
         "\n"
         "#   bytesize: 8\n"
         "#   method: rtu\n"
         "#   parity: N\n"
         "#   stopbits: 1\n";
}

}  // namespace

std::string home_assistant_hub(const Model& model, const NetworkAddress& network_address) {
  const Hub hub(model, network_address);
  const Json entities = hub.hub();
  return head(model, network_address) + polls(model, entities) + yaml_of(Json::array({entities})) +
         "# Actions for items without an entity:\n" + hub.actions() + hub.watchdog_actions();
}

}  // namespace ex9000::sim
