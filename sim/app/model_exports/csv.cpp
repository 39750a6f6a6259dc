#include <boost/algorithm/string/replace.hpp>

#include "firmware/dcon/commands.hpp"
#include "sim/app/model_exports/access.hpp"
#include "sim/app/model_exports/formats.hpp"
#include "sim/app/model_exports/register_map.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

/// The cells of one row, in the order of the titles.
struct Row {
  std::string model;
  std::string table;    ///< `DCON command`, or Area::name of the coil, discrete input or register
  std::string address;  ///< the protocol address of a coil, discrete input or register, in decimal
  std::string plc_number;
  std::string channel;
  std::string functions;  ///< Modbus function codes in hex
  std::string command;
  std::string reply;
  std::string access;
  std::string range;
  std::string needs_init;
  std::string id;
  std::string meaning;
};

/// Returns the text of a cell. If `text` contains a comma, a quote or a line break, the result is in quotes,
/// and each quote of `text` is doubled.
std::string quoted_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    return text;
  }
  return '"' + boost::replace_all_copy(text, "\"", "\"\"") + '"';
}

std::string line(const Row& row) {
  std::string text;
  for (const std::string* each :
       {&row.model, &row.table, &row.address, &row.plc_number, &row.channel, &row.functions, &row.command,
        &row.reply, &row.access, &row.range, &row.needs_init, &row.id}) {
    text += quoted_cell(*each) + ",";
  }
  return text + quoted_cell(row.meaning) + "\r\n";
}

std::string command_line(const Model& model, const dcon::Command& command) {
  Row row;
  row.model = model.designation;
  row.table = "DCON command";
  row.command = command.syntax;
  row.reply = command.reply;
  row.access = access_text(command.access);
  row.range = command.range;
  row.needs_init = command.dispatch.init != dcon::Init::NotRequired ? "yes" : "no";
  row.id = command.id;
  row.meaning = command.meaning;
  return line(row);
}

std::string register_line(const Model& model, const MapRow& of, unsigned address) {
  Row row;
  row.model = model.designation;
  row.table = of.area->name;
  row.address = std::to_string(address);
  row.plc_number = plc_number(*of.area, address);
  row.channel = of.per_channel ? std::to_string(address - of.first) : "";
  row.functions = hex_text(of.functions, " ");
  row.access = access_text(of.reads, of.writes);
  row.range = of.range;
  row.id = of.id;
  row.meaning = of.meaning;
  return line(row);
}

}  // namespace

std::string csv_of(const Models& models) {
  std::string text = line({"model", "table", "address", "plc_number", "channel", "functions", "command",
                           "reply", "access", "range", "needs_init", "id", "meaning"});
  for (const Model* model : models) {
    for (const dcon::Command& command : dcon::kCommands) {
      if (meets(*model, command.dispatch.needs)) {
        text += command_line(*model, command);
      }
    }
    for (const MapRow& row : register_map(*model)) {
      for (unsigned address = row.first; address <= row.last; ++address) {
        text += register_line(*model, row, address);
      }
    }
  }
  return text;
}

}  // namespace ex9000::sim
