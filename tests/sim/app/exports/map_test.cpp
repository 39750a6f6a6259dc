// Compares the Modbus map of the exports with the reference, a second implementation of a module.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sim/app/exports/description.hpp"
#include "sim/app/play/modbus_frame.hpp"
#include "tests/oracles/reference/module.hpp"

namespace ex9000::sim {
namespace {

using Json = nlohmann::ordered_json;

std::string access_of(const std::string& table, unsigned address, unsigned function) {
  return table + " " + std::to_string(address) + " " + std::to_string(function);
}

/// Returns each access that the map of a model lists.
std::set<std::string> listed(const Model& model) {
  std::set<std::string> all;
  const Json described = description({&model});
  for (const Json& row : described.at("models").at(0).at("modbus_registers")) {
    for (const Json& item : row.at("items")) {
      for (const Json& function : row.at("functions")) {
        all.insert(access_of(row.at("table"), item.at("address"), function));
      }
    }
  }
  return all;
}

/// Returns whether a new module of the reference has the function and the address: it does not reply with
/// exception 01 or 02.
bool is_accepted(const reference::ModelRow& model, unsigned function, unsigned address) {
  reference::Module module(model);
  reference::Stored stored;
  stored.modbus = true;
  module.store(stored);
  module.power(true, {});
  module.select_mode(false);
  const auto high = static_cast<std::uint8_t>(address >> 8);
  const auto low = static_cast<std::uint8_t>(address & 0xFF);
  reference::Bytes request{0x01, static_cast<std::uint8_t>(function), high, low, 0x00, 0x01};
  if (function == 0x05) {
    request[4] = 0xFF;
    request[5] = 0x00;
  } else if (function == 0x0F) {
    request.insert(request.end(), {0x01, 0x01});
  } else if (function == 0x10) {
    request.insert(request.end(), {0x02, 0x00, 0x01});
  }
  const reference::Bytes frame = with_crc(request);
  const reference::Bytes reply = module.on_frame(frame, std::vector<bool>(frame.size()), {}).reply;
  return reply.size() != 5 || reply[1] != (function | 0x80U) || reply[2] > 0x02;
}

/// Returns each access to this table that the reference accepts.
void add_accepted(const reference::ModelRow& model, const char* table, const std::vector<unsigned>& functions,
                  std::set<std::string>& all) {
  for (const unsigned function : functions) {
    for (const auto& [first, last] :
         {std::pair(0U, 0x08FFU), {0x0FF0U, 0x1020U}, {0x1FF0U, 0x2050U}, {0x3030U, 0x303FU}}) {
      for (unsigned address = first; address <= last; ++address) {
        if (is_accepted(model, function, address)) {
          all.insert(access_of(table, address, function));
        }
      }
    }
  }
}

TEST(Map, ListsWhatTheReferenceAccepts) {
  for (const reference::ModelRow& row : reference::kModelRows) {
    const Model& model = *find_model(row.designation);
    std::set<std::string> accepted;
    if (row.both_protocols) {
      add_accepted(row, "coil", {0x01, 0x05, 0x0F}, accepted);
      add_accepted(row, "discrete input", {0x02}, accepted);
      add_accepted(row, "input register", {0x04}, accepted);
      add_accepted(row, "holding register", {0x03, 0x06, 0x10}, accepted);
    }
    const std::set<std::string> map = listed(model);
    std::vector<std::string> differences;
    std::set_symmetric_difference(map.begin(), map.end(), accepted.begin(), accepted.end(),
                                  std::back_inserter(differences));
    EXPECT_EQ(differences, std::vector<std::string>()) << model.designation;
  }
}

}  // namespace
}  // namespace ex9000::sim
