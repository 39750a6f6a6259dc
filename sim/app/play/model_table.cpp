#include "sim/app/play/model_table.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "sim/files_and_ports/files/regular_file.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::play {

namespace {

using sim::fail;
using sim::Words;

bool contains(const Words& words, const std::string& word) {
  return std::count(words.begin(), words.end(), word) != 0;
}

ModelEntry& entry_of(const Model& model, ModelTable& table) {
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&model](const ModelEntry& entry) { return entry.model == &model; });
  return found != table.end() ? *found : table.emplace_back(ModelEntry{&model, {}, {}});
}

/// `headings`: of the columns; the first is that of the models.
void add_row(const Words& row, const Words& headings, ModelTable& table) {
  if (row.size() != headings.size()) {
    fail("has " + std::to_string(row.size()) + " columns; expected " + std::to_string(headings.size()) +
         ", like the line 'model ...' above");
  }
  ModelEntry& entry = entry_of(model_named(row[0]), table);
  for (std::size_t column = 1; column < row.size(); ++column) {
    if (headings[column] == "classes") {
      entry.classes = sim::parts_of(row[column], ',');
    } else if (!entry.variables.insert({headings[column], row[column]}).second) {
      fail("'" + headings[column] + "' is given twice; leave out one of them");
    }
  }
}

bool belongs(const ModelEntry& entry, const std::string& to) {
  return to == "all" || to == entry.model->designation || contains(entry.classes, to);
}

void check_class(const std::string& name, const ModelTable& table) {
  if (std::any_of(table.begin(), table.end(),
                  [&name](const ModelEntry& entry) { return belongs(entry, name); })) {
    return;
  }
  Words known{"all"};
  for (const ModelEntry& entry : table) {
    std::copy_if(entry.classes.begin(), entry.classes.end(), std::back_inserter(known),
                 [&known](const std::string& each) { return !contains(known, each); });
  }
  fail("'" + name + "' is not a class; expected one of " + sim::joined(known, ", "));
}

}  // namespace

const Model& model_named(const std::string& name) {
  const Model* model = find_model(name);
  if (model == nullptr) {
    sim::refuse_model(name);
  }
  return *model;
}

std::string table_path_for(const std::string& transcript) {
  const std::filesystem::path path = std::filesystem::absolute(transcript);
  for (std::filesystem::path above = path; above != above.parent_path();) {
    above = above.parent_path();
    const std::filesystem::path table = above / "models.table";
    std::error_code unknown;
    if (std::filesystem::is_regular_file(table, unknown)) {
      return table.string();
    }
  }
  return "";
}

ModelTable read_model_table(const std::string& path) {
  std::ifstream file = sim::open_text_file(path);
  ModelTable table;
  Words headings;
  unsigned line = 0;
  try {
    for (std::string text; std::getline(file, text);) {
      ++line;
      const Words row = sim::words_of(text);
      if (row.empty() || row[0][0] == ';') {
        continue;
      }
      if (row[0] == "model") {
        headings = row;
      } else {
        add_row(row, headings, table);
      }
    }
  } catch (const std::exception& error) {
    fail(path + ":" + std::to_string(line) + ": " + error.what());
  }
  return table;
}

std::vector<const Model*> models_of(const ModelTable& table, const Words& words) {
  if (table.empty()) {
    fail("'models:' requires a table of models; name models in 'model:' lines");
  }
  std::vector<const Model*> models;
  for (const ModelEntry& entry : table) {
    if (std::all_of(words.begin(), words.end(), [&entry](const std::string& word) {
          return word[0] == '-' ? !belongs(entry, word.substr(1)) : belongs(entry, word);
        })) {
      models.push_back(entry.model);
    }
  }
  for (const std::string& word : words) {
    check_class(word[0] == '-' ? word.substr(1) : word, table);
  }
  if (models.empty()) {
    fail("no model belongs to these classes");
  }
  return models;
}

}  // namespace ex9000::play
