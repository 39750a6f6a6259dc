// Users wire a board according to its README, so the tables of the README must match board.hpp. This test is
// built once for each board.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include EX9000_PINS_HEADER
#include "firmware/model/model.hpp"

namespace ex9000::board {
namespace {

using Row = std::vector<std::string>;
using Table = std::vector<Row>;  ///< the first row is the header

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, at);) {
    parts.push_back(trimmed(part));
  }
  return parts;
}

std::string text_of(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<Table> tables_in(const char* readme) {
  std::vector<Table> result;
  std::istringstream file(text_of(readme));
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind('|', 0) != 0) {
      inside = false;
    } else if (!inside) {
      inside = true;
      result.push_back({split(line.substr(1), '|')});
    } else if (line.rfind("|--", 0) != 0) {
      result.back().push_back(split(line.substr(1), '|'));
    }
  }
  return result;
}

/// Returns the table whose first column has the header `head`. Returns an empty table if `readme` contains no
/// such table.
Table table_in(const char* readme, const std::string& head) {
  Table found;
  for (const Table& table : tables_in(readme)) {
    if (table[0][0] == head) {
      EXPECT_TRUE(found.empty()) << "two tables have the header " << head;
      found = table;
    }
  }
  return found;
}

/// Returns the table of the board under test. `head` is the header of the first column of the table.
Table table_of(const std::string& head) {
#ifdef EX9000_BASE_README
  // The README of the board contains only the rows that differ from the rows of another board, on which this
  // board is based.
  Table found = table_in(EX9000_BASE_README, head);
  for (const Row& row : table_in(EX9000_BOARD_README, head)) {
    const auto same = std::find_if(found.begin(), found.end(),
                                   [&row](const Row& other) { return other.at(0) == row.at(0); });
    if (same == found.end()) {
      ADD_FAILURE() << row.at(0) << " has no row in " << EX9000_BASE_README;
    } else {
      *same = row;
    }
  }
#else
  Table found = table_in(EX9000_BOARD_README, head);
#endif
  EXPECT_FALSE(found.empty()) << "no table has the header " << head;
  return found;
}

/// Returns the name of an output on the model's label: for channel 0, RL1 or DO0 (wire.md section 1).
std::string output_label(const Model& model, unsigned channel) {
  const bool is_relay = model.description.find("relay") != std::string_view::npos ||
                        model.description.find("PhotoMOS") != std::string_view::npos;
  return is_relay ? "RL" + std::to_string(channel + 1) : "DO" + std::to_string(channel);
}

using Terminals = std::map<std::string, std::set<std::string>>;  ///< by pin

/// Returns the terminals in the column `head` of the table.
Terminals terminals_in(const std::string& head) {
  const Table table = table_of("pin");
  const auto column = std::find(table[0].begin(), table[0].end(), head) - table[0].begin();
  Terminals terminals;
  for (auto row = table.begin() + 1; row != table.end(); ++row) {
    const std::vector<std::string> names = split(row->at(static_cast<std::size_t>(column)), ',');
    EXPECT_TRUE(terminals.emplace(row->at(0), std::set<std::string>(names.begin(), names.end())).second)
        << row->at(0) << " is listed twice";
  }
  return terminals;
}

TEST(Wiring, TheReadmeListsThePinOfEveryTerminalOfEveryModelOfTheBoard) {
  const std::vector<std::string> output_pins = names_of(kOutputs);
  const std::vector<std::string> input_pins = names_of(kInputs);
  Terminals outputs;
  Terminals inputs;
  for (const Model& model : kModels) {
    if (model.outputs > output_pins.size() || model.inputs > input_pins.size()) {
      continue;  // has no image for this board
    }
    std::set<std::string> used;
    for (unsigned channel = 0; channel < model.outputs; ++channel) {
      outputs[output_pins.at(channel)].insert(output_label(model, channel));
      EXPECT_TRUE(used.insert(output_pins.at(channel)).second) << model.designation;
    }
    for (unsigned channel = 0; channel < model.inputs; ++channel) {
      inputs[input_pins.at(channel)].insert("DI" + std::to_string(channel));
      EXPECT_TRUE(used.insert(input_pins.at(channel)).second) << model.designation;
    }
  }
  EXPECT_EQ(terminals_in("output"), outputs);
  if (!input_pins.empty()) {
    EXPECT_EQ(terminals_in("input"), inputs);
  }
}

TEST(Wiring, TheReadmeListsThePinsOfTheCommonSignals) {
  std::map<std::string, std::string> written;
  const Table table = table_of("signal");
  for (auto row = table.begin() + 1; row != table.end(); ++row) {
    written[row->at(0)] = row->at(1);
  }
#ifdef EX9000_BOARD_HAS_HEADERS
  // The table of the README describes the image for a transceiver. Another section describes the image
  // without a transceiver.
  static_assert(kUart == 1);
#endif
  std::map<std::string, std::string> expected = names_of_peripherals();
  expected["driver enable"] = name_of(kDriverEnable);
  expected["INIT*"] = name_of(kInitSwitch);
  expected["status LED"] = name_of(kStatusLed);
  EXPECT_EQ(written, expected);
}

TEST(Wiring, TheOutputPinsAndTheSignalPinsAreDistinct) {
  std::set<std::string> pins;
  const auto add = [&pins](const std::string& pin) { EXPECT_TRUE(pins.insert(pin).second) << pin; };
  for (const std::string& pin : names_of(kOutputs)) {
    add(pin);
  }
  const Table table = table_of("signal");
  for (auto row = table.begin() + 1; row != table.end(); ++row) {
    add(row->at(1));
  }
}

TEST(Wiring, NoTableListsAReservedPin) {
  for (const Table& table : {table_of("pin"), table_of("signal")}) {
    for (const Row& row : table) {
      for (const std::string& pin : kReservedPins) {
        EXPECT_EQ(std::count(row.begin(), row.begin() + 2, pin), 0) << pin;
      }
    }
  }
}

// A position is for example "J4.4" on the EK-TM4C123GXL, and "4" on a Pico.
#ifdef EX9000_BOARD_HAS_HEADERS
const char* const kColumn = "header";
const char* const kNone = "";  // each pin in the tables is at a header
const char* const kLead = " (P";

/// The pins at positions 1 to 10 of each header of the EK-TM4C123GXL (user's guide SPMU296, "Headers and
/// BoosterPacks").
const std::map<std::string, std::array<std::string, 10>> kHeaders{
    {"J1", {"3.3V", "PB5", "PB0", "PB1", "PE4", "PE5", "PB4", "PA5", "PA6", "PA7"}},
    {"J2", {"GND", "PB2", "PE0", "PF0", "RESET", "PB7", "PB6", "PA4", "PA3", "PA2"}},
    {"J3", {"5V", "GND", "PD0", "PD1", "PD2", "PD3", "PE1", "PE2", "PE3", "PF1"}},
    {"J4", {"PF2", "PF3", "PB3", "PC4", "PC5", "PC6", "PC7", "PD6", "PD7", "PF4"}},
};

std::string pin_at(const std::string& position) {
  const std::size_t dot = position.find('.');
  const int place = dot == std::string::npos ? 0 : std::stoi(position.substr(dot + 1));
  const auto header = kHeaders.find(position.substr(0, dot));
  return header != kHeaders.end() && place >= 1 && place <= 10
             ? header->second.at(static_cast<std::size_t>(place - 1))
             : "nothing";
}
#endif
#ifdef EX9000_BOARD_HAS_POSITIONS
const char* const kColumn = "position";
const char* const kNone = "–";
const char* const kLead = " (GP";

std::string pin_at(const std::string& position) { return kPositions.at(std::stoul(position) - 1); }
#endif

#if defined(EX9000_BOARD_HAS_HEADERS) || defined(EX9000_BOARD_HAS_POSITIONS)
TEST(Wiring, EveryPositionInTheTablesMatchesItsPin) {
  for (const auto& [head, pin_column] : std::map<std::string, std::size_t>{{"pin", 0}, {"signal", 1}}) {
    const Table table = table_of(head);
    ASSERT_EQ(table[0].at(pin_column + 1), kColumn);
    for (auto row = table.begin() + 1; row != table.end(); ++row) {
      if (const std::string& position = row->at(pin_column + 1); position != kNone) {
        EXPECT_EQ(pin_at(position), row->at(pin_column)) << position;
      }
    }
  }
}

TEST(Wiring, EveryPositionInTheTextMatchesItsPin) {
#ifdef EX9000_BASE_README
  const std::string text = text_of(EX9000_BASE_README) + text_of(EX9000_BOARD_README);
#else
  const std::string text = text_of(EX9000_BOARD_README);
#endif
  int named = 0;
  for (auto open = text.find(kLead); open != std::string::npos; open = text.find(kLead, open + 1)) {
    const auto start = text.find_last_of(" \n", open - 1) + 1;
    const std::string position = text.substr(start, open - start);  // "J4.4" of "J4.4 (PC4)"
    if (position[0] == 'J' || std::isdigit(static_cast<unsigned char>(position[0])) != 0) {
      EXPECT_EQ(pin_at(position), text.substr(open + 2, text.find(')', open) - open - 2)) << position;
      ++named;
    }
  }
  EXPECT_GE(named, 1);
}
#endif

}  // namespace
}  // namespace ex9000::board
