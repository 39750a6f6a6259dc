#include "sim/app/model_exports/describe.hpp"

#include "firmware/settings/settings.hpp"
#include "sim/app/model_exports/formats.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

/// Exactly one of the three functions is set.
struct Format {
  const char* name = "";
  std::string (*of_models)(const Models& models) = nullptr;
  // The next two functions require a model that supports Modbus.
  std::string (*of_model)(const Model& model) = nullptr;
  std::string (*of_module)(const Model& model, const NetworkAddress& network_address) = nullptr;
};

constexpr Format kFormats[] = {
    {"markdown", markdown_of, nullptr, nullptr},
    {"json", json_of, nullptr, nullptr},
    {"csv", csv_of, nullptr, nullptr},
    {"home-assistant", nullptr, nullptr, home_assistant_hub},
    {"node-red", nullptr, nullptr, node_red_flow},
    {"wb-mqtt-serial", nullptr, wb_mqtt_serial_template, nullptr},
};

const Format& format_called(const std::string& name) {
  for (const Format& format : kFormats) {
    if (name == format.name) {
      return format;
    }
  }
  fail("--format " + name + ": expected " + describe_formats());
}

std::uint8_t parse_modbus_address(const std::string& text) {
  const std::uint8_t address = with_place("--address ", [&] { return parse_hex_byte(text); });
  if (!is_modbus_address(address)) {
    fail("--address " + text + ": expected a Modbus address, hex 01 to F7");
  }
  return address;
}

TcpAddress parse_master_address(const std::string& option, const std::string& text) {
  TcpAddress tcp = with_place(option + " ", [&] { return parse_tcp_address(text); });
  const std::string of_hosts = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_:%";
  if (tcp.port == 0 || tcp.host.find_first_not_of(of_hosts) != std::string::npos) {
    fail(option + " " + text + ": expected HOST:PORT of a simulator, for example 127.0.0.1:5020");
  }
  return tcp;
}

NetworkAddress parse_network_address(const DescribeTexts& texts) {
  NetworkAddress network_address;
  if (texts.address) {
    network_address.address = parse_modbus_address(*texts.address);
  }
  if (texts.tcp && texts.modbus_tcp) {
    fail("--modbus-tcp: cannot be combined with --tcp; leave out one of them");
  }
  if (texts.tcp) {
    network_address.tcp = parse_master_address("--tcp", *texts.tcp);
  }
  if (texts.modbus_tcp) {
    network_address.tcp = parse_master_address("--modbus-tcp", *texts.modbus_tcp);
    network_address.modbus_tcp = true;
  }
  return network_address;
}

/// Rejects --address, --tcp and --modbus-tcp, which are valid only with a format that sets `of_module`.
void refuse_place(const DescribeTexts& texts) {
  const std::string option = texts.address      ? "--address"
                             : texts.tcp        ? "--tcp"
                             : texts.modbus_tcp ? "--modbus-tcp"
                                                : "";
  if (!option.empty()) {
    fail(option + ": --format " + texts.format + " has no such option; leave it out");
  }
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

std::string describe_formats() { return names_of(kFormats, "|"); }

std::string describe(const DescribeTexts& texts) {
  const Format& format = format_called(texts.format);
  if (format.of_module != nullptr) {
    const NetworkAddress network_address = parse_network_address(texts);
    return format.of_module(modbus_model(texts), network_address);
  }
  refuse_place(texts);
  if (format.of_model != nullptr) {
    return format.of_model(modbus_model(texts));
  }
  return format.of_models(texts.model.empty() ? all_models() : Models{&model_called(texts.model)});
}

}  // namespace ex9000::sim
