// Reads the files in stored_bytes/: memory contents that a firmware has stored. From the first release on, a
// file is never regenerated, because the memories of modules in the field contain such bytes. The lines of a
// file:
//
//     # comment
//     model DESIGNATION
//     at ADDRESS          hex; the bytes that follow begin there; bytes that the file does not contain are FF
//       BYTES
//     settings            the settings of a module with this memory follow; values are hex, except the name
//       NAME VALUE
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "tests/oracles/stored_copy.hpp"

namespace ex9000 {

struct StoredBytes {
  std::string file;
  const Model* model = nullptr;
  std::vector<std::uint8_t> memory = std::vector<std::uint8_t>(kStoredMemory, 0xFF);
  Settings settings;
};

inline StoredBytes read_stored_bytes(const std::filesystem::path& path) {
  StoredBytes stored;
  stored.file = path.filename().string();
  std::map<std::string, std::string> values;
  std::ifstream lines(path);
  std::size_t at = 0;
  bool in_settings = false;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "#") {
      continue;
    }
    if (word == "model") {
      words >> word;
      stored.model = find_model(word);
    } else if (word == "at") {
      words >> std::hex >> at;
    } else if (word == "settings") {
      in_settings = true;
    } else if (in_settings) {
      std::getline(words >> std::ws, values[word]);
    } else {
      std::istringstream bytes(line);
      for (unsigned byte = 0; bytes >> std::hex >> byte;) {
        stored.memory.at(at++) = static_cast<std::uint8_t>(byte);
      }
    }
  }
  const auto number = [&](const char* name) { return std::stoul(values.at(name), nullptr, 16); };
  Settings& settings = stored.settings;
  settings.address = static_cast<std::uint8_t>(number("address"));
  settings.baud_code = static_cast<std::uint8_t>(number("baud_code"));
  settings.format = static_cast<std::uint8_t>(number("format"));
  settings.protocol = number("protocol") != 0 ? Protocol::ModbusRtu : Protocol::Ascii;
  settings.watchdog_timeout = static_cast<std::uint8_t>(number("watchdog_timeout"));
  settings.watchdog_enabled = number("watchdog_enabled") != 0;
  settings.timeout_status = number("timeout_status") != 0;
  settings.name = Name(std::string_view(values.at("name")));
  settings.power_on_value = static_cast<std::uint16_t>(number("power_on_value"));
  settings.safe_value = static_cast<std::uint16_t>(number("safe_value"));
  settings.updates_allowed = true;  // the factory value of what no file contains
  return stored;
}

/// Reads all files. Checks that there are at least `kAtLeast` files; increase `kAtLeast` when you add files.
/// Throws std::runtime_error if a file names an unknown model or no model. Throws std::logic_error if a file
/// lacks a setting or the number of a setting, or has a byte beyond the end of the memory.
inline std::vector<StoredBytes> all_stored_bytes() {
  constexpr std::size_t kAtLeast = 19;
  std::vector<StoredBytes> all;
  for (const auto& entry : std::filesystem::directory_iterator("tests/firmware/settings/stored_bytes")) {
    all.push_back(read_stored_bytes(entry.path()));
    if (all.back().model == nullptr) {
      throw std::runtime_error(
          entry.path().string() +
          ": the model is missing or unknown; expected a designation of the model table");
    }
  }
  EXPECT_GE(all.size(), kAtLeast);
  return all;
}

}  // namespace ex9000
