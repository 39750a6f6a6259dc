// The table of models for the transcripts in a folder. tests/conformance/README.md defines the format.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "sim/text/words.hpp"

namespace ex9000::play {

using Variables = std::map<std::string, std::string>;

/// What the table says about a model.
struct ModelEntry {
  const Model* model;
  sim::Words classes;
  Variables variables;
};

/// The models in the order of their first rows. Empty: there is no table.
using ModelTable = std::vector<ModelEntry>;

/// Returns the row with this designation. Throws std::invalid_argument with a one-line message if there is
/// none.
const Model& model_named(const std::string& name);

/// Returns the path of the table for a transcript: `models.table` in the folder of the transcript or in the
/// nearest folder above it. Returns an empty text if there is none.
std::string table_path_for(const std::string& transcript);

/// Reads a table. Throws std::invalid_argument that names the file, the line and what is wrong.
ModelTable read_model_table(const std::string& path);

/// Returns the models that belong to all classes in `words` and to none after `-`. Each model is a class of
/// its own, and all models belong to the class `all`. Throws std::invalid_argument with a one-line message if
/// a class does not exist or if no model remains.
std::vector<const Model*> models_of(const ModelTable& table, const sim::Words& words);

}  // namespace ex9000::play
