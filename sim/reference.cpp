#include "sim/reference.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"
#include "firmware/modbus/functions.hpp"
#include "firmware/modbus/registers.hpp"
#include "firmware/model/baud.hpp"
#include "sim/module_spec.hpp"

namespace ex9000::sim {

namespace {

using Models = std::vector<const Model*>;

// --- Markdown ---

using Cells = std::vector<std::string>;

constexpr const char* kNone = "-";

std::string code(std::string_view text) { return "`" + std::string(text) + "`"; }

/// A pipe would end the cell, even inside backticks.
std::string cell(std::string_view text) {
  std::string escaped;
  for (const char character : text) {
    escaped += character == '|' ? std::string("\\|") : std::string(1, character);
  }
  return escaped.empty() ? kNone : escaped;
}

std::string table_line(const Cells& cells) {
  std::string line = "|";
  for (const std::string& text : cells) {
    line += " " + cell(text) + " |";
  }
  return line + "\n";
}

std::string table_head(const Cells& titles) {
  std::string rule = "|";
  for (std::size_t i = 0; i < titles.size(); ++i) {
    rule += "---|";
  }
  return table_line(titles) + rule + "\n";
}

std::string join(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) {
    text += (text.empty() ? "" : ", ") + part;
  }
  return text;
}

std::string hex_word(unsigned value) { return "0x" + hex_byte_text(value >> 8U) + hex_byte_text(value); }

std::string range_text(const std::string& first, const std::string& last) {
  return first == last ? first : first + "-" + last;
}

// --- which models ---

Models all_models() {
  Models models;
  for (const Model& model : kModels) {
    models.push_back(&model);
  }
  return models;
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

/// The models that `has` is true of: the kind that they are, or their names where they are no kind.
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
  return join(names);
}

/// Adds the column of models, which says nothing where there is but one.
void add_who(const Models& models, Cells& cells, const std::string& text) {
  if (models.size() > 1) {
    cells.push_back(text);
  }
}

template <class Has>
bool any_has(const Models& models, Has has) {
  return std::any_of(models.begin(), models.end(), [&](const Model* model) { return has(*model); });
}

// --- models ---

std::string channels(unsigned number) { return number == 0 ? kNone : std::to_string(number); }

/// Where a reply has the one channel that is on: the position of its byte among the data.
std::size_t data_byte_of(const Model& model, bool is_output, unsigned channel) {
  const auto on = static_cast<std::uint16_t>(1U << channel);
  Reply reply;
  reply.clear();
  dcon::put_data(model, is_output ? on : std::uint16_t{0}, is_output ? std::uint16_t{0} : on, reply);
  const auto digit =
      std::find_if(reply.bytes().begin(), reply.bytes().end(), [](std::uint8_t c) { return c != '0'; });
  return static_cast<std::size_t>(digit - reply.bytes().begin()) / 2;
}

/// What (First) or (Second) holds: DO8-12, say.
std::string data_byte(const Model& model, std::size_t byte) {
  for (const bool is_output : {true, false}) {
    std::vector<std::string> held;
    for (unsigned channel = 0; channel < (is_output ? model.outputs : model.inputs); ++channel) {
      if (data_byte_of(model, is_output, channel) == byte) {
        held.push_back(std::to_string(channel));
      }
    }
    if (!held.empty()) {
      return (is_output ? "DO" : "DI") + range_text(held.front(), held.back());
    }
  }
  return "00";
}

std::string models_table(const Models& models) {
  std::string text = table_head({"model", "what it is", "inputs", "outputs", "protocols", "factory name",
                                 "Modbus code", code("First"), code("Second"), code("SS")});
  for (const Model* model : models) {
    text +=
        table_line({std::string(model->designation), std::string(model->description), channels(model->inputs),
                    channels(model->outputs), model->speaks_modbus() ? "ASCII, Modbus RTU" : "ASCII",
                    code(model->factory_name), model->speaks_modbus() ? hex_word(model->modbus_code) : kNone,
                    data_byte(*model, 0), data_byte(*model, 1),
                    model->status_style == StatusStyle::TimeoutOnly ? "00, 04" : "00, 80, 84"});
  }
  return text;
}

// --- DCON ---

std::string baud_codes() {
  std::vector<std::string> codes;
  for (std::uint8_t baud = kFirstBaudCode; baud <= kLastBaudCode; ++baud) {
    codes.push_back(hex_byte_text(baud) + " " + std::to_string(baud_rate(baud)));
  }
  return join(codes);
}

/// What the letters of the syntax stand for, and what other answers there are.
std::string dcon_notes(const Models& models) {
  const bool outputs = any_has(models, [](const Model& model) { return model.has_outputs(); });
  const bool inputs = any_has(models, [](const Model& model) { return model.has_inputs(); });
  std::string text =
      "- `AA` is the module's address in hex, `**` all modules, which do not answer. CR ends every request "
      "and reply. With the checksum enabled, two hex digits stand before CR: the sum of all characters "
      "before them, modulo 256.\n"
      "- `(First)` and `(Second)` are two hex digits each; the table above says of which channels (relay RL1 "
      "is DO0), and bit 0 is the lowest of them.";
  text += inputs ? " `$AALS` has latches in place of inputs, and 00 in place of outputs." : "";
  text += outputs ? " `~AA4V` has 00 in place of inputs." : "";
  text +=
      "\n- `TT` is 40; `CC` the baud rate: " + baud_codes() +
      "; `FF` 80 where counters count rising edges instead of falling ones, plus 40 with checksum.\n"
      "- `SS` is 04 or 84 after a timeout of the host watchdog, 80 while it is enabled, else 00; the table "
      "above says which of them a model has.\n"
      "- A refused command is answered `?AA`.";
  text += outputs ? " Models with outputs answer `?` to a refused one that sets outputs, and `!` to one that "
                    "is ignored because the timeout status is set."
                  : "";
  return text +
         "\n- Access: what is *stored* is in the EEPROM before the reply leaves. (I): only with INIT* tied "
         "to GND.\n";
}

/// `!AA10 or !AA11` are two pieces of code.
std::string reply_code(std::string_view reply) {
  constexpr std::string_view kOr = " or ";
  const auto at = reply.find(kOr);
  if (reply.empty()) {
    return kNone;
  }
  return at == std::string_view::npos
             ? code(reply)
             : code(reply.substr(0, at)) + std::string(kOr) + reply_code(reply.substr(at + kOr.size()));
}

const char* access_text(dcon::Access access) {
  switch (access) {
    case dcon::Access::Read:
      return "read";
    case dcon::Access::Write:
      return "write";
    case dcon::Access::Store:
      break;
  }
  return "stored";
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
    Cells cells{code(command.syntax),       reply_code(command.reply),   std::string(command.meaning),
                std::string(command.range), access_text(command.access), command.needs_init ? "(I)" : kNone};
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
                function.row.by_broadcast ? "done by all modules, without answer" : "ignored"};
    add_who(models, cells, who(models, has));
    text += table_line(cells);
  }
  return text;
}

/// One of the four tables of Modbus.
struct Area {
  const char* name;
  char digit;  ///< in front of its numbers
  modbus::Functions reads;
  modbus::Functions writes;
};

constexpr std::array<Area, 4> kAreas{{
    {"coil", '0', modbus::kReadCoils, modbus::kWriteSingleCoil | modbus::kWriteMultipleCoils},
    {"discrete input", '1', modbus::kReadDiscreteInputs, 0},
    {"input register", '3', modbus::kReadInputRegisters, 0},
    {"holding register", '4', modbus::kReadHoldingRegisters, modbus::kWriteRegisters},
}};

modbus::Functions functions_of(const modbus::BitRow& row) { return row.functions; }

/// A row without functions is host OK, which is read and never looked up.
modbus::Functions functions_of(const modbus::WordRow& row) {
  return row.functions != 0 ? row.functions : modbus::kReadHoldingRegisters | modbus::kReadInputRegisters;
}

std::string function_codes(modbus::Functions functions) {
  std::vector<std::string> codes;
  for (unsigned function = 0; function < 16; ++function) {
    if ((functions >> function & 1U) != 0) {
      codes.push_back(hex_byte_text(function));
    }
  }
  if ((functions & modbus::kWriteRegisters) != 0) {
    codes.push_back(hex_byte_text(0x10));
  }
  return join(codes);
}

std::string access_text(bool reads, bool writes) {
  return reads && writes ? "read, write" : reads ? "read" : "write";
}

/// As PLCs count: from 1, in at least four digits behind that of the table.
std::string plc_number(const Area& area, unsigned address) {
  constexpr std::size_t kDigits = 4;
  const std::string number = std::to_string(address + 1);
  return area.digit + std::string(number.size() < kDigits ? kDigits - number.size() : 0, '0') + number;
}

template <class Register>
std::string register_line(const Model& model, const Area& area, const Register& entry) {
  const auto& row = entry.row;
  const modbus::Functions functions = functions_of(row);
  const bool reads = (functions & area.reads) != 0;
  const bool writes = (functions & area.writes) != 0;
  if (!meets(model, row.needs) || (!reads && !writes)) {
    return "";
  }
  const unsigned last = row.first + modbus::width_of(row.width, model) - 1;
  return table_line({area.name, range_text(hex_word(row.first), hex_word(last)),
                     range_text(plc_number(area, row.first), plc_number(area, last)),
                     function_codes(functions & (area.reads | area.writes)), access_text(reads, writes),
                     writes ? std::string(entry.range) : kNone, std::string(entry.meaning)});
}

std::string map_table(const Model& model) {
  std::string text =
      table_head({"table", "address", "PLC number", "functions", "access", "may be written", "what it is"});
  for (const Area& area : kAreas) {
    for (const modbus::BitRegister& entry : modbus::kBitRegisters) {
      text += register_line(model, area, entry);
    }
    for (const modbus::WordRegister& entry : modbus::kWordRegisters) {
      text += register_line(model, area, entry);
    }
  }
  return text;
}

std::string map_notes() {
  return "Addresses count from 0, as on the line; PLC numbers count from 1 behind the digit of their table. "
         "What is written is stored in the EEPROM, unless it is the outputs or clears latches or counters. "
         "Writes that drive outputs get exception 04 while the timeout status is set. "
         "Baud codes are those of `CC` above.\n";
}

/// Models whose maps are equal, and their map.
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
  std::string text = map_notes();
  for (const SharedMap& map : shared_maps(models)) {
    text += models.size() > 1 ? "\n#### " + join(map.models) + "\n" : "";
    text += "\n" + map.table;
  }
  return text;
}

std::string commands_and_registers(const Models& models) {
  std::string text = "\n### DCON (ASCII) commands\n\n" + dcon_notes(models) + "\n" + commands_table(models);
  if (any_has(models, [](const Model& model) { return model.speaks_modbus(); })) {
    text += "\n### Modbus functions\n\n" + functions_table(models);
    text += "\n### Modbus coils and registers\n\n" + maps_text(models);
  }
  return text;
}

}  // namespace

std::string reference() {
  const Models models = all_models();
  return "### Models\n\n" + models_table(models) + commands_and_registers(models);
}

std::string reference(const Model& model) {
  const Models models{&model};
  return "## " + std::string(model.designation) + ": " + std::string(model.description) + "\n\n" +
         models_table(models) + commands_and_registers(models);
}

}  // namespace ex9000::sim
