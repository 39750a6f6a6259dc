// Tests the description of models in CSV, for spreadsheets. `rows_of` parses the description according to
// RFC 4180. The expected commands, addresses and counts are from wire.md and firmware/extensions.md.
#include "sim/app/model_exports/formats.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace ex9000::sim {
namespace {

using Cells = std::vector<std::string>;

std::vector<Cells> rows_of(const std::string& text) {
  std::vector<Cells> rows;
  Cells cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (quoted) {
      if (text[i] != '"') {
        cells.back() += text[i];
      } else if (i + 1 < text.size() && text[i + 1] == '"') {
        cells.back() += text[++i];
      } else {
        quoted = false;
      }
    } else if (text[i] == '"') {
      EXPECT_EQ(cells.back(), "") << "a quote within an unquoted cell, at " << i;
      quoted = true;
    } else if (text[i] == ',') {
      cells.emplace_back();
    } else if (text.compare(i, 2, "\r\n") == 0) {
      rows.push_back(cells);
      cells = Cells(1);
      ++i;
    } else {
      EXPECT_NE(text[i], '\n') << "a line without CR, at " << i;
      cells.back() += text[i];
    }
  }
  EXPECT_FALSE(quoted);
  EXPECT_EQ(cells, Cells(1)) << "the last line does not end with CR LF";
  return rows;
}

std::vector<Cells> table_of(const char* designation) { return rows_of(csv_of({find_model(designation)})); }

/// Returns the first row with this table, and with `which` as its address or command. Returns an empty row if
/// there is none.
Cells row(const char* designation, const std::string& table, const std::string& which) {
  for (const Cells& cells : table_of(designation)) {
    if (cells[1] == table && (cells[2] == which || cells[6] == which)) {
      return cells;
    }
  }
  return {};
}

TEST(DescribeCsv, HasAHeaderAndAllCellsInEveryRow) {
  const std::vector<Cells> rows = rows_of(csv_of(all_models()));
  EXPECT_EQ(rows.front(), (Cells{"model", "table", "address", "plc_number", "channel", "functions", "command",
                                 "reply", "access", "range", "needs_init", "id", "meaning"}));
  for (const Cells& cells : rows) {
    EXPECT_EQ(cells.size(), 13U) << cells.front();
  }
}

TEST(DescribeCsv, HasOneRowPerCommandCoilAndRegister) {
  // 25 commands, 3 x 13 coils for outputs, 3 general coils and 5 holding registers. The tables of the holding
  // registers and of the input registers both contain the host OK and the extensions: 2 settings, 13 timed
  // outputs and 15 others.
  EXPECT_EQ(table_of("EX9042D-M").size(), 1U + 25 + 39 + 3 + 5 + 2 * (1 + 2 + 13 + 15));
  // 27 commands, because the model has inputs and outputs. The table contains no coils or registers, because
  // the model does not support Modbus.
  EXPECT_EQ(table_of("EX9055D").size(), 1U + 27);
}

TEST(DescribeCsv, ACommandRowHasSyntaxReplyAccessAndMeaning) {
  EXPECT_EQ(row("EX9042D-M", "DCON command", "~AA3EVV"),
            (Cells{"EX9042D-M", "DCON command", "", "", "", "", "~AA3EVV", "!AA", "stored",
                   "E: 0 off, 1 on; VV: timeout 01-FF in units of 0.1 s", "no", "set-watchdog",
                   "set the host watchdog"}));
  EXPECT_EQ(row("EX9042D-M", "DCON command", "$AAPN")[10], "yes");
}

TEST(DescribeCsv, EachChannelHasItsAddress) {
  EXPECT_EQ(row("EX9042D-M", "coil", "140"),  // 0x8C
            (Cells{"EX9042D-M", "coil", "140", "00141", "12", "01 05 0F", "", "", "read, write",
                   "0 off, 1 on", "", "safe-value", "safe value; a write also drives the outputs"}));
  EXPECT_EQ(row("EX9042D-M", "coil", "141"), Cells());
  EXPECT_EQ(row("EX9052D-M", "discrete input", "7"),
            (Cells{"EX9052D-M", "discrete input", "7", "10008", "7", "02", "", "", "read", "", "", "inputs",
                   "inputs"}));
  EXPECT_EQ(row("EX9052D-M", "holding register", "484")[3], "40485");  // 0x01E4
}

}  // namespace
}  // namespace ex9000::sim
