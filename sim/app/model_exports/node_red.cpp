#include <array>
#include <nlohmann/json.hpp>

#include "sim/app/model_exports/formats.hpp"
#include "sim/app/model_exports/shown.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

using Json = nlohmann::ordered_json;

constexpr unsigned kPollSeconds = 1;

// The layout of the tab, in pixels: the left column's x, and the distances between columns and between rows.
constexpr unsigned kLeft = 140;
constexpr unsigned kColumn = 240;
constexpr unsigned kRow = 40;

/// The values of dataType, in the order of the enumeration Table.
constexpr std::array<const char*, 4> kDataTypes{"Coil", "Input", "InputRegister", "HoldingRegister"};

const char* data_type(Table table) { return kDataTypes[static_cast<std::size_t>(table)]; }

class Flow {
 public:
  Flow(const Model& model, const NetworkAddress& network_address)
      : module_(std::string(model.designation) + " " + hex_byte_text(network_address.address)),
        key_(model_key(model) + "_" + hex_byte_text(network_address.address)),
        network_address_(network_address) {
    add_tab();
    add_client();
    for (const Shown& shown : shown_by(model)) {
      add(shown);
    }
  }

  [[nodiscard]] std::string text() const { return nodes_.dump(2) + "\n"; }

 private:
  /// Returns sixteen hex digits, like Node-RED's own ids: the FNV-1a hash of the module's key and the node's
  /// name.
  [[nodiscard]] std::string id(const std::string& node) const {
    std::uint64_t hash = 0xCBF29CE484222325;
    for (const char character : key_ + "/" + node) {
      hash = (hash ^ static_cast<std::uint8_t>(character)) * 0x100000001B3;
    }
    std::string digits;
    for (unsigned shift = 64; shift != 0; shift -= 4) {
      digits += "0123456789abcdef"[hash >> (shift - 4) & 0xFU];
    }
    return digits;
  }

  /// Returns a node on the tab, in the current row.
  [[nodiscard]] Json node(const std::string& name, const char* type, unsigned column) const {
    return {{"id", id(name)},
            {"type", type},
            {"z", id("tab")},
            {"x", kLeft + column * kColumn},
            {"y", (row_ + 1) * kRow}};
  }

  void add_tab() {
    nodes_.push_back({{"id", id("tab")},
                      {"type", "tab"},
                      {"label", module_},
                      {"disabled", false},
                      {"info", "Requires node-red-contrib-modbus."}});
  }

  void add_client() {
    nodes_.push_back({{"id", id("client")},
                      {"type", "modbus-client"},
                      {"name", "line of " + module_},
                      {"clienttype", "tcp"},
                      {"tcpHost", network_address_.tcp.host},
                      {"tcpPort", std::to_string(network_address_.tcp.port)},
                      // TELNET sends RTU frames, as on the line; DEFAULT sends Modbus TCP frames.
                      {"tcpType", network_address_.modbus_tcp ? "DEFAULT" : "TELNET"},
                      // The client sends one request at a time, because all modules share one line.
                      {"bufferCommands", true},
                      {"parallelUnitIdsAllowed", false},
                      {"unit_id", std::to_string(network_address_.address)},
                      {"commandDelay", "30"},
                      {"clientTimeout", "1000"},
                      {"reconnectOnTimeout", true},
                      {"reconnectTimeout", "2000"}});
  }

  void add(const Shown& shown) {
    if (shown.role != Role::Button) {
      add_reading(shown);
    }
    for (unsigned index = 0; index < shown.width; ++index) {
      if (shown.role == Role::Output) {
        add_write(shown, index, {{"on", true}, {"off", false}});
      } else if (shown.role == Role::Button) {
        add_write(shown, index, {{"clear", true}});
      }
    }
  }

  /// Adds a node that reads all items of `shown` with one request, and a node that shows their values.
  void add_reading(const Shown& shown) {
    const std::string name = "read " + std::string(shown.id);
    Json read = node(name, "modbus-read", 1);
    read["name"] = shown.name;
    read["topic"] = shown.id;
    read["unitid"] = std::to_string(network_address_.address);
    read["dataType"] = data_type(shown.table);
    read["adr"] = std::to_string(shown.first);
    read["quantity"] = std::to_string(shown.width);
    read["rate"] = std::to_string(kPollSeconds);
    read["rateUnit"] = "s";
    read["server"] = id("client");
    read["showErrors"] = true;
    read["wires"] = {{id("show " + name)}, Json::array()};
    nodes_.push_back(read);
    nodes_.push_back(debug(name, std::string(shown.name)));
    ++row_;
  }

  /// Adds a node that writes item `index` of `shown`, and a node that shows the written values. For each of
  /// `values`, also adds a row with a node that sends this value to the node that writes.
  void add_write(const Shown& shown, unsigned index,
                 const std::vector<std::pair<const char*, bool>>& values) {
    const std::string key = shown.key_of(index);
    Json write = node("write " + key, "modbus-write", 1);
    write["name"] = shown.name_of(index);
    write["unitid"] = std::to_string(network_address_.address);
    write["dataType"] = data_type(shown.table);
    write["adr"] = std::to_string(shown.first + index);
    write["quantity"] = "1";
    write["server"] = id("client");
    write["showErrors"] = true;
    write["wires"] = {{id("show " + key)}, Json::array()};
    const Json show = debug(key, shown.name_of(index));
    for (const auto& [word, value] : values) {
      Json inject = node("inject " + key + word, "inject", 0);
      inject["name"] = word;
      inject["props"] = Json::array({{{"p", "payload"}}});
      inject["payload"] = value ? "true" : "false";
      inject["payloadType"] = "bool";
      inject["wires"] = Json::array({Json::array({id("write " + key)})});
      nodes_.push_back(inject);
      ++row_;
    }
    nodes_.push_back(write);
    nodes_.push_back(show);
  }

  /// Returns a node that shows values. Its id is `id("show " + of)`; users see `name`.
  [[nodiscard]] Json debug(const std::string& of, const std::string& name) const {
    Json debug = node("show " + of, "debug", 2);
    debug["name"] = name;
    debug["active"] = true;
    debug["tosidebar"] = true;
    debug["complete"] = "payload";
    debug["targetType"] = "msg";
    debug["wires"] = Json::array();
    return debug;
  }

  std::string module_;
  std::string key_;
  const NetworkAddress& network_address_;
  Json nodes_ = Json::array();
  unsigned row_ = 0;
};

}  // namespace

std::string node_red_flow(const Model& model, const NetworkAddress& network_address) {
  return Flow(model, network_address).text();
}

}  // namespace ex9000::sim
