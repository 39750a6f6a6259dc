#include <nlohmann/json.hpp>

#include "firmware/dcon/commands.hpp"
#include "firmware/modbus/functions.hpp"
#include "sim/app/model_exports/access.hpp"
#include "sim/app/model_exports/data_bytes.hpp"
#include "sim/app/model_exports/formats.hpp"
#include "sim/app/model_exports/register_map.hpp"

namespace ex9000::sim {

namespace {

using Json = nlohmann::ordered_json;

Json text_or_null(std::string_view text) { return text.empty() ? Json() : Json(text); }

Json command(const dcon::Command& command) {
  return {{"id", command.id},
          {"command", command.syntax},
          {"reply", text_or_null(command.reply)},
          {"meaning", command.meaning},
          {"arguments", text_or_null(command.range)},
          {"access", access_text(command.access)},
          {"needs_init", command.dispatch.init != dcon::Init::NotRequired}};
}

Json commands(const Model& model) {
  Json all = Json::array();
  for (const dcon::Command& row : dcon::kCommands) {
    if (meets(model, row.dispatch.needs)) {
      all.push_back(command(row));
    }
  }
  return all;
}

Json functions(const Model& model) {
  Json all = Json::array();
  for (const modbus::Function& function : modbus::kFunctions) {
    if (model.speaks_modbus() && meets(model, function.row.needs)) {
      all.push_back({{"code", function.row.code},
                     {"name", function.name},
                     {"by_broadcast", function.row.at_broadcast == modbus::AtBroadcast::CarriedOut}});
    }
  }
  return all;
}

Json registers(const Model& model) {
  Json all = Json::array();
  for (const MapRow& row : register_map(model)) {
    all.push_back({{"id", row.id},
                   {"table", row.area->name},
                   {"first", row.first},
                   {"last", row.last},
                   {"plc_first", plc_number(*row.area, row.first)},
                   {"plc_last", plc_number(*row.area, row.last)},
                   {"functions", row.functions},
                   {"access", access_text(row.reads, row.writes)},
                   {"range", text_or_null(row.range)},
                   {"meaning", row.meaning}});
  }
  return all;
}

Json protocols(const Model& model) {
  return model.speaks_modbus() ? Json{"ascii", "modbus-rtu"} : Json::array({"ascii"});
}

Json described(const Model& model) {
  return {{"model", model.designation},
          {"description", model.description},
          {"inputs", model.inputs},
          {"outputs", model.outputs},
          {"protocols", protocols(model)},
          {"factory_name", model.factory_name},
          {"longest_name", model.longest_name},
          {"modbus_code", model.speaks_modbus() ? Json(model.modbus_code) : Json()},
          {"first_data_byte", data_byte(model, 0)},
          {"second_data_byte", data_byte(model, 1)},
          {"status_readings", status_readings(model)},
          {"dcon_commands", commands(model)},
          {"modbus_functions", functions(model)},
          {"modbus_registers", registers(model)}};
}

}  // namespace

std::string json_of(const Models& models) {
  Json all = Json::array();
  for (const Model* model : models) {
    all.push_back(described(*model));
  }
  return Json{{"firmware", kFirmwareVersion}, {"models", all}}.dump(2) + "\n";
}

}  // namespace ex9000::sim
