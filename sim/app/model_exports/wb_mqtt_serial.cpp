#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "firmware/model/baud.hpp"
#include "sim/app/model_exports/formats.hpp"
#include "sim/app/model_exports/shown.hpp"

namespace ex9000::sim {

namespace {

using Json = nlohmann::ordered_json;

/// The values of reg_type, in the order of the enumeration Table.
constexpr std::array<const char*, 4> kRegisterTypes{"coil", "discrete", "input", "holding"};

/// The silence between two frames at the factory baud rate, in microseconds: 3.5 characters of 11 bits.
constexpr unsigned kSilenceMicroseconds = 38'500'000 / baud_rate(kFactoryBaudCode);

Json channel(const Shown& shown, unsigned index) {
  Json channel{{"name", shown.name_of(index)},
               {"id", shown.key_of(index)},
               {"reg_type", kRegisterTypes[static_cast<std::size_t>(shown.table)]}};
  // wb-mqtt-serial must not poll the coils of buttons, because some of these coils are write-only.
  channel[shown.role == Role::Button ? "write_address" : "address"] = shown.first + index;
  switch (shown.role) {
    case Role::Output:
      channel["type"] = "switch";
      return channel;
    case Role::Button:
      channel["type"] = "pushbutton";
      return channel;
    case Role::Problem:
      channel["type"] = "alarm";
      break;
    case Role::Counter:
      channel["type"] = "value";
      channel["format"] = "u16";
      break;
    case Role::Tenths:
      channel["type"] = "value";
      channel["format"] = "u16";
      channel["scale"] = 0.1;
      channel["round_to"] = 0.1;
      channel["units"] = "s";
      break;
    case Role::Preset:
      channel["type"] = "switch";
      channel["enabled"] = false;
      break;
    case Role::Input:
    case Role::State:
      channel["type"] = "switch";
      break;
  }
  channel["readonly"] = true;
  return channel;
}

}  // namespace

std::string wb_mqtt_serial_template(const Model& model) {
  Json channels = Json::array();
  unsigned widest = 0;
  for (const Shown& shown : shown_by(model)) {
    widest = std::max(widest, shown.width);
    for (unsigned index = 0; index < shown.width; ++index) {
      channels.push_back(channel(shown, index));
    }
  }
  const std::string key = model_key(model);
  const Json device{{"name", model.designation},    {"id", key},
                    {"max_read_registers", widest}, {"guard_interval_us", kSilenceMicroseconds},
                    {"response_timeout_ms", 500},   {"channels", channels}};
  const Json all{{"title", std::string(model.designation) + ", " + std::string(model.description)},
                 {"device_type", model.designation},
                 {"group", "g-io"},
                 {"device", device}};
  return all.dump(4) + "\n";
}

}  // namespace ex9000::sim
