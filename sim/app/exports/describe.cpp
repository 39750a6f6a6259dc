#include "sim/app/exports/describe.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "firmware/settings/settings.hpp"
#include "sim/app/exports/description.hpp"
#include "sim/app/exports/template.hpp"
#include "sim/files_and_ports/ports/tcp_address.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/embedded_files.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

using Json = nlohmann::ordered_json;

struct Format {
  std::string name;
  std::string scope;
  std::string help;
  std::string_view text;
};

std::vector<Format> formats() {
  std::vector<Format> all;
  for (const EmbeddedFile& file : export_templates()) {
    constexpr std::string_view kBegin = "{{! ";
    const std::size_t colon = file.content.find(": ");
    const std::size_t end = file.content.find(" }}\n");
    all.push_back({std::string(file.name.substr(0, file.name.find('.'))),
                   std::string(file.content.substr(kBegin.size(), colon - kBegin.size())),
                   std::string(file.content.substr(colon + 2, end - colon - 2)), file.content});
  }
  return all;
}

Format format_called(const std::string& name) {
  for (const Format& format : formats()) {
    if (name == format.name) {
      return format;
    }
  }
  fail("--format " + name + ": expected " + format_names());
}

std::uint8_t parse_modbus_address(const std::string& text) {
  const std::uint8_t address = with_place("--address: ", [&] { return parse_hex_byte(text); });
  if (!is_modbus_address(address)) {
    fail("--address: '" + text + "': expected a Modbus address, hex 01 to F7");
  }
  return address;
}

/// As a master names it: HOST can be a name, unlike in --port of the simulator.
struct MasterPort {
  TcpAddress tcp;
  bool modbus_tcp = false;  ///< Modbus TCP frames; false: RTU frames
};

MasterPort parse_master_port(const std::string& text) {
  const std::string of_hosts = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_:%";
  const auto colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  MasterPort port;
  port.modbus_tcp = kind == "modbus-tcp";
  if (colon != std::string::npos && (port.modbus_tcp || kind == "tcp")) {
    port.tcp = with_place("--port: ", [&] { return parse_tcp_address(text.substr(colon + 1)); });
  }
  if (port.tcp.port == 0 || port.tcp.host.find_first_not_of(of_hosts) != std::string::npos) {
    fail("--port: '" + text +
         "': expected tcp:HOST:PORT or modbus-tcp:HOST:PORT of a simulator, for example tcp:127.0.0.1:5020");
  }
  return port;
}

void refuse(const char* option, const std::optional<std::string>& text, const DescribeTexts& texts) {
  if (text) {
    fail(std::string(option) + ": --format " + texts.format + " has no such option; leave it out");
  }
}

/// What a tool requires to reach it.
Json module_of(const Json& model, const Format& format, const DescribeTexts& texts) {
  const std::uint8_t address = parse_modbus_address(texts.address.value_or("01"));
  Json module{{"name", model["model"].get<std::string>() + " " + hex_byte_text(address)},
              {"key", model["model_key"].get<std::string>() + "_" + hex_byte_text(address)},
              {"address", address}};
  if (format.scope == "port") {
    const MasterPort port = parse_master_port(texts.port.value_or("tcp:127.0.0.1:5020"));
    module.update({{"host", port.tcp.host}, {"port", port.tcp.port}, {"modbus_tcp", port.modbus_tcp}});
  }
  return module;
}

const Model& modbus_model(const DescribeTexts& texts) {
  if (texts.model.empty()) {
    fail("--format " + texts.format + ": requires a MODEL, for example 'describe EX9042D-M'");
  }
  const Model& model = model_called(texts.model);
  if (!model.speaks_modbus()) {
    fail(std::string(model.designation) + " --format " + texts.format +
         ": the model does not support Modbus; name a model that --models lists with Modbus RTU, or use "
         "--format json");
  }
  return model;
}

}  // namespace

std::string format_names() { return names_of(formats(), "|"); }

std::string format_help() {
  std::string lines;
  for (const Format& format : formats()) {
    constexpr std::size_t kWidth = 16;
    const char* const options = format.scope == "port"      ? " (MODEL; --address, --port)"
                                : format.scope == "address" ? " (MODEL; --address)"
                                : format.scope == "model"   ? " (MODEL)"
                                                            : "";
    std::string name = format.name + " ";
    name.resize(std::max(kWidth, name.size()), ' ');
    lines += "  " + name + format.help + options + "\n";
  }
  return lines;
}

std::string describe(const DescribeTexts& texts) {
  const Format format = format_called(texts.format);
  if (format.scope != "port") {
    refuse("--port", texts.port, texts);
  }
  if (format.scope == "any" || format.scope == "model") {
    refuse("--address", texts.address, texts);
  }
  if (format.scope == "any") {
    const Models models = texts.model.empty() ? all_models() : Models{&model_called(texts.model)};
    return filled_in(format.text, description(models));
  }
  Json data = description({&modbus_model(texts)});
  data["module"] = module_of(data["models"][0], format, texts);
  return filled_in(format.text, data);
}

}  // namespace ex9000::sim
