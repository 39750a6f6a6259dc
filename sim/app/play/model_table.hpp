// The table of models for the transcripts in a folder. tests/conformance/README.md defines the format.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "sim/text/words.hpp"

namespace ex9000::play {

using Variables = std::map<std::string, std::string>;

struct ModelEntry {
  const Model* model;
  sim::Words classes;
  Variables variables;
};

/// In the order of their first rows. Empty: there is no table.
using ModelTable = std::vector<ModelEntry>;

const Model& model_named(const std::string& name);

/// `models.table` in the transcript's folder or the nearest folder above it; empty: there is none.
std::string table_path_for(const std::string& transcript);

/// An error names the file and the line.
ModelTable read_model_table(const std::string& path);

/// Those in all classes in `words` and in none after `-`. Each model is a class of its own, and all are in
/// `all`. Throws if a class does not exist or no model remains.
std::vector<const Model*> models_of(const ModelTable& table, const sim::Words& words);

}  // namespace ex9000::play
