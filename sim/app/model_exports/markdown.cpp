#include <algorithm>
#include <array>
#include <boost/algorithm/string/replace.hpp>
#include <string_view>
#include <vector>

#include "firmware/dcon/commands.hpp"
#include "firmware/modbus/functions.hpp"
#include "firmware/model/baud.hpp"
#include "sim/app/model_exports/access.hpp"
#include "sim/app/model_exports/data_bytes.hpp"
#include "sim/app/model_exports/formats.hpp"
#include "sim/app/model_exports/register_map.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

// --- Markdown ---

using Cells = std::vector<std::string>;

constexpr const char* kNone = "-";

std::string code(std::string_view text) { return "`" + std::string(text) + "`"; }

/// Escapes each pipe, because a pipe would end the cell even inside backticks. Returns `-` for an empty text.
std::string escaped_cell(const std::string& text) {
  return text.empty() ? kNone : boost::replace_all_copy(text, "|", "\\|");
}

std::string table_line(const Cells& cells) {
  std::string line = "|";
  for (const std::string& text : cells) {
    line += " " + escaped_cell(text) + " |";
  }
  return line + "\n";
}

std::string table_head(const Cells& titles) {
  return table_line(titles) + "|" + joined(Cells(titles.size(), "---"), "|") + "|\n";
}

std::string hex_word(unsigned value) { return "0x" + hex_word_text(value); }

std::string range_text(const std::string& first, const std::string& last) {
  return first == last ? first : first + "-" + last;
}

// --- which models ---

template <class Has>
bool any_has(const Models& models, Has has) {
  return std::any_of(models.begin(), models.end(), [&](const Model* model) { return has(*model); });
}

struct Kind {
  const char* name;
  bool (*holds)(const Model& model);
};

constexpr std::array<Kind, 4> kKinds{{
    {"all", [](const Model& /*model*/) { return true; }},
    {"with outputs", [](const Model& model) { return model.has_outputs(); }},
    {"with inputs", [](const Model& model) { return model.has_inputs(); }},
    {"-M", [](const Model& model) { return model.speaks_modbus(); }},
}};

/// Describes the models for which `has` is true: by the name of a kind that contains these models and no
/// others of `models`, or by their own names if there is no such kind.
template <class Has>
std::string who(const Models& models, Has has) {
  for (const Kind& kind : kKinds) {
    if (std::all_of(models.begin(), models.end(),
                    [&](const Model* model) { return kind.holds(*model) == has(*model); })) {
      return kind.name;
    }
  }
  std::vector<std::string> names;
  for (const Model* model : models) {
    if (has(*model)) {
      names.emplace_back(model->designation);
    }
  }
  return joined(names, ", ");
}

/// Adds the title or a cell of the column that names models. A description of a single model has no such
/// column.
void add_who(const Models& models, Cells& cells, const std::string& text) {
  if (models.size() > 1) {
    cells.push_back(text);
  }
}

// --- models ---

std::string channels(unsigned number) { return number == 0 ? kNone : std::to_string(number); }

std::string models_table(const Models& models) {
  std::string text = table_head({"model", "what it is", "inputs", "outputs", "protocols", "factory name",
                                 "Modbus code", code("First"), code("Second"), code("SS")});
  for (const Model* model : models) {
    text +=
        table_line({std::string(model->designation), std::string(model->description), channels(model->inputs),
                    channels(model->outputs), model->speaks_modbus() ? "ASCII, Modbus RTU" : "ASCII",
                    code(model->factory_name), model->speaks_modbus() ? hex_word(model->modbus_code) : kNone,
                    data_byte(*model, 0), data_byte(*model, 1), status_readings(*model)});
  }
  return text;
}

// --- DCON ---

std::string baud_codes() {
  std::vector<std::string> codes;
  for (std::uint8_t baud = kFirstBaudCode; baud <= kLastBaudCode; ++baud) {
    codes.push_back(hex_byte_text(baud) + " " + std::to_string(baud_rate(baud)));
  }
  return joined(codes, ", ");
}

/// Returns the notes above the table of commands, for example on the letters in the syntax and on the replies
/// to rejected commands.
std::string dcon_notes(const Models& models) {
  const bool outputs = any_has(models, [](const Model& model) { return model.has_outputs(); });
  const bool inputs = any_has(models, [](const Model& model) { return model.has_inputs(); });
  std::string text =
      "- `AA` is the module's address in hex. `**` addresses all modules, and no module replies. CR ends "
      "every request and reply. If the checksum is enabled, two hex digits precede CR: the sum of all "
      "characters before these digits, modulo 256.\n"
      "- `(First)` and `(Second)` are two hex digits each; the table above lists their channels (relay RL1 "
      "is DO0); bit 0 is the lowest channel.";
  text += inputs ? " The reply to `$AALS` has latches in place of inputs, and 00 in place of outputs." : "";
  text += outputs ? " The reply to `~AA4V` has 00 in place of inputs." : "";
  text +=
      "\n- `TT` is 40, and `%` also accepts 24. `CC` is the code of the baud rate: " + baud_codes() +
      "; plus 40, 80 or C0 for the line formats 8N2, 8E1 and 8O1. `FF` is 80 if the counters count rising "
      "edges, otherwise 00; the checksum adds 40 to `FF`. All codes are in hex.\n"
      "- `SS` is 04 or 84 while the timeout status is set. Otherwise, on models with the value 80, it is 80 "
      "while the host watchdog is enabled. In all other cases it is 00. The table above lists the values of "
      "each model.\n"
      "- The reply to a rejected command is `?AA`.";
  text += outputs
              ? " Models with outputs reply `?` to a rejected command that sets outputs. While the "
                "timeout status is set, they reply `!` to a valid command that sets outputs, and ignore it."
              : "";
  return text +
         "\n- Access: a *stored* value is in the EEPROM before the module replies. (I): the module must run "
         "in INIT mode, or INIT* must be tied to GND when the command arrives. For `%` this applies only to "
         "a change of `CC` or of the checksum.\n";
}

/// Formats a reply as code, and alternatives, for example `!AA10 or !AA11`, as separate pieces of code.
/// Returns `-` for an empty text.
std::string reply_code(std::string_view reply) {
  return reply.empty() ? kNone : boost::replace_all_copy(code(reply), " or ", "` or `");
}

std::string commands_table(const Models& models) {
  Cells titles{"command", "valid reply", "what it does", "arguments", "access", "(I)"};
  add_who(models, titles, "models");
  std::string text = table_head(titles);
  for (const dcon::Command& command : dcon::kCommands) {
    const auto has = [&](const Model& model) { return meets(model, command.dispatch.needs); };
    if (!any_has(models, has)) {
      continue;
    }
    Cells cells{
        code(command.syntax),         reply_code(command.reply),
        std::string(command.meaning), std::string(command.range),
        access_text(command.access),  command.dispatch.init != dcon::Init::NotRequired ? "(I)" : kNone};
    add_who(models, cells, who(models, has));
    text += table_line(cells);
  }
  return text;
}

// --- Modbus ---

std::string functions_table(const Models& models) {
  Cells titles{"function", "name", "at address 0"};
  add_who(models, titles, "models");
  std::string text = table_head(titles);
  for (const modbus::Function& function : modbus::kFunctions) {
    const auto has = [&](const Model& model) {
      return model.speaks_modbus() && meets(model, function.row.needs);
    };
    if (!any_has(models, has)) {
      continue;
    }
    Cells cells{hex_byte_text(function.row.code), std::string(function.name),
                function.row.at_broadcast == modbus::AtBroadcast::CarriedOut
                    ? "executed or refused, without a reply"
                    : "ignored"};
    add_who(models, cells, who(models, has));
    text += table_line(cells);
  }
  return text;
}

std::string map_table(const Model& model) {
  std::string text =
      table_head({"table", "address", "PLC number", "functions", "access", "may be written", "what it is"});
  for (const MapRow& row : register_map(model)) {
    text += table_line({row.area->name, range_text(hex_word(row.first), hex_word(row.last)),
                        range_text(plc_number(*row.area, row.first), plc_number(*row.area, row.last)),
                        hex_text(row.functions, ", "), access_text(row.reads, row.writes),
                        std::string(row.range), std::string(row.meaning)});
  }
  return text;
}

/// The models that have the same map, and this map.
struct SharedMap {
  std::vector<std::string> models;
  std::string table;
};

std::vector<SharedMap> shared_maps(const Models& models) {
  std::vector<SharedMap> maps;
  for (const Model* model : models) {
    if (!model->speaks_modbus()) {
      continue;
    }
    const std::string table = map_table(*model);
    auto same =
        std::find_if(maps.begin(), maps.end(), [&](const SharedMap& map) { return map.table == table; });
    if (same == maps.end()) {
      same = maps.insert(maps.end(), SharedMap{{}, table});
    }
    same->models.emplace_back(model->designation);
  }
  return maps;
}

std::string maps_text(const Models& models) {
  const bool outputs = any_has(models, [](const Model& model) { return model.has_outputs(); });
  std::string text =
      "Addresses count from 0, as on the line; PLC numbers count from 1 after the digit of their table. "
      "Writes store their values in the EEPROM, except writes ";
  text += outputs ? "of `outputs` and of `timed output`, and writes " : "";
  text += "that clear latches, counters or the count of timeouts. ";
  text += outputs ? "Writes that drive outputs get exception 04 while the timeout status is set. " : "";
  text += "Baud codes are those of `CC` above.\n";
  for (const SharedMap& map : shared_maps(models)) {
    text += models.size() > 1 ? "\n#### " + joined(map.models, ", ") + "\n" : "";
    text += "\n" + map.table;
  }
  return text;
}

std::string commands_and_registers(const Models& models) {
  std::string text = "\n### DCON (ASCII) commands\n\n" + dcon_notes(models) + "\n" + commands_table(models);
  if (any_has(models, [](const Model& model) { return model.speaks_modbus(); })) {
    text +=
        "\n### Modbus functions\n\n" + functions_table(models) +
        "\nAt address 0, the host OK (a read of 0x3038) is executed, and writes marked `not by broadcast` "
        "are ignored.\n";
    text += "\n### Modbus coils and registers\n\n" + maps_text(models);
  }
  return text;
}

}  // namespace

std::string markdown_of(const Models& models) {
  const Model& first = *models.front();
  const std::string heading =
      models.size() == 1 ? "## " + std::string(first.designation) + ": " + std::string(first.description)
                         : "### Models";
  return heading + "\n\n" + models_table(models) + commands_and_registers(models);
}

}  // namespace ex9000::sim
