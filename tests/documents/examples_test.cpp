// If a section of a document has a `text` block, the test runs the examples of this section. If a `sh` block
// begins with a command that starts a simulator, this block runs in the first terminal. The simulator runs
// until the test stops it. All other `sh` blocks and all `python` blocks run in a second terminal. The `text`
// blocks are the expected output of the second terminal. A `yaml` block is the content of the file
// `bus.yaml`, and a `python` block that begins with `# NAME.py` that of NAME.py. Apart from these files, the
// working directory at first contains only links to `boards` and `build`, because the examples use the
// programs and images there. For the line `sim/run`, the test runs only the last command of sim/run. The
// script itself also installs packages and builds the simulator; tests/first-command runs the script. Another
// test in this file checks that the tables of the documents list each option, control command and fault that
// `ex9000-sim --help` lists.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/child_process.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/free_port.hpp"
#include "tests/support/in_repository.hpp"
#include "tests/support/left_out.hpp"
#include "tests/support/simulator_process.hpp"

namespace ex9000::system {
namespace {

struct Block {
  std::string language;
  std::string text;
};

struct Section {
  std::string heading;
  std::vector<Block> blocks;
};

/// Returns the paths of the documents, relative to the project's root.
std::vector<std::string> documents() {
  std::vector<std::string> paths;
  std::istringstream list(EX9000_DOCUMENTS);
  for (std::string path; std::getline(list, path, ' ');) {
    paths.push_back(path);
  }
  return paths;
}

/// Returns the last command of sim/run, with `ex9000-sim` in place of the path, and without the arguments
/// that sim/run passes on. Throws std::runtime_error if sim/run starts no simulator.
std::string command_of_sim_run() {
  const std::string program = "exec \"$here/build/host/sim/ex9000-sim\" ";
  std::ifstream file("sim/run");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(program, 0) == 0) {
      const std::string arguments = line.substr(program.size());
      return "ex9000-sim " + arguments.substr(0, arguments.find(" \"$@\"")) + "\n";
    }
  }
  throw std::runtime_error("sim/run: no line starts the simulator; expected " + program);
}

std::vector<Section> sections_of(const std::string& document) {
  std::vector<Section> result(1, {document, {}});
  std::ifstream file(document);
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("```", 0) == 0) {
      inside = !inside;
      if (inside) {
        result.back().blocks.push_back({line.substr(3), ""});
      }
    } else if (inside) {
      result.back().blocks.back().text += line == "sim/run" ? command_of_sim_run() : line + "\n";
    } else if (line.rfind("##", 0) == 0) {
      result.push_back({document + line.substr(line.find(' ')), {}});
    }
  }
  return result;
}

/// Replaces the TCP port 5020 of the documents with `port`, because another program on this machine may use
/// port 5020.
void replace_port(std::string& text, const std::string& port) {
  const std::string written = "5020";
  for (auto at = text.find(written); at != std::string::npos; at = text.find(written, at + port.size())) {
    text.replace(at, written.size(), port);
  }
}

/// Sets two timeouts of the examples to 10 s: the time for which socat waits after a request, and the time
/// for which mbpoll waits for a reply. A busy machine can require more time than the documents state.
void extend_timeouts(std::string& text) {
  text = std::regex_replace(text, std::regex("socat -t [0-9.]+ "), "socat -t 10 ");
  text = std::regex_replace(text, std::regex("mbpoll -"), "mbpoll -o 10 -");
}

/// Returns whether the section is an example of pymodbus, which `tests/run --without pymodbus` does not
/// install.
bool requires_pymodbus(const Section& section) {
  return std::any_of(section.blocks.begin(), section.blocks.end(), [](const Block& block) {
    return block.language == "python" && block.text.find("pymodbus") != std::string::npos;
  });
}

/// Returns whether the block begins with an `ex9000-sim` command that does not end by itself.
/// `ex9000-sim describe` and `ex9000-sim play` end by themselves.
bool starts_the_simulator(const Block& block) {
  const auto begins_with = [&](const char* text) { return block.text.rfind(text, 0) == 0; };
  return begins_with("ex9000-sim ") && !begins_with("ex9000-sim describe") && !begins_with("ex9000-sim play");
}

/// For a `python` block that is the content of a file, the name of this file, else empty.
std::string file_of(const Block& block) {
  std::smatch name;
  return block.language == "python" && std::regex_search(block.text, name, std::regex("^# (\\w+\\.py)\n"))
             ? name[1].str()
             : "";
}

/// The second terminal. All its blocks run in one shell, because later blocks use functions and jobs of
/// earlier blocks.
class Shell {
 public:
  void paste(const Block& block) {
    script_ +=
        block.language == "python" ? "/usr/bin/python3 - <<'PYTHON'\n" + block.text + "PYTHON\n" : block.text;
  }
  [[nodiscard]] Finished run_in(const std::string& directory) const {
    return run({"bash", "-c", "trap 'kill $(jobs -p) 2>/dev/null' EXIT\n" + script_}, directory);
  }

 private:
  std::string script_;
};

void paste(const Section& section) {
  const Directory directory;
  for (const std::string folder : {"boards", "build"}) {
    std::filesystem::create_symlink(in_repository(folder), directory / folder);
  }
  std::unique_ptr<ChildProcess> simulator;
  Shell shell;
  std::string expected;
  for (const Block& block : section.blocks) {
    if (block.language == "text") {
      expected += block.text;
    } else if (block.language == "yaml") {
      write_file(directory / "bus.yaml", block.text);
    } else if (const std::string file = file_of(block); !file.empty()) {
      write_file(directory / file, block.text);
    } else if (block.language == "sh" && starts_the_simulator(block)) {
      simulator = std::make_unique<ChildProcess>(std::vector<std::string>{"sh", "-c", "exec " + block.text},
                                                 directory.path(), ChildProcess::Errors::WithOutput);
      ASSERT_TRUE(simulator->wait_for("press Ctrl-C to end")) << block.text;
    } else if (block.language == "sh" || block.language == "python") {
      shell.paste(block);
    }
  }
  const Finished finished = shell.run_in(directory.path());
  EXPECT_EQ(finished.output, expected) << finished.error;
}

std::vector<Section> sections_with_output() {
  std::vector<Section> all;
  for (const std::string& document : documents()) {
    const std::vector<Section> sections = sections_of(document);
    all.insert(all.end(), sections.begin(), sections.end());
  }
  const auto has_none = [](const Section& section) {
    return std::none_of(section.blocks.begin(), section.blocks.end(),
                        [](const Block& block) { return block.language == "text"; });
  };
  all.erase(std::remove_if(all.begin(), all.end(), has_none), all.end());
  return all;
}

/// Runs all sections in parallel, because they mostly wait.
void paste_all(std::vector<Section> pasted) {
  const std::string programs = simulator_path().substr(0, simulator_path().rfind('/'));
  setenv("PATH", (programs + ":" + getenv("PATH")).c_str(), 1);
  std::vector<std::thread> readers;
  for (std::size_t i = 0; i < pasted.size(); ++i) {
    readers.emplace_back([&section = pasted[i], port = std::to_string(free_port())] {
      SCOPED_TRACE(section.heading);
      for (Block& block : section.blocks) {
        replace_port(block.text, port);
        extend_timeouts(block.text);
      }
      paste(section);
    });
  }
  for (std::thread& reader : readers) {
    reader.join();
  }
}

TEST(Documents, ExamplesWithoutPymodbusPrintTheExpectedOutput) {
  std::vector<Section> pasted = sections_with_output();
  pasted.erase(std::remove_if(pasted.begin(), pasted.end(), requires_pymodbus), pasted.end());
  EXPECT_GE(pasted.size(), 14U);
  paste_all(std::move(pasted));
}

TEST(Documents, ExamplesOfPymodbusPrintTheExpectedOutput) {
  if (without("pymodbus")) {
    GTEST_SKIP() << "left out: pymodbus";
  }
  std::vector<Section> pasted = sections_with_output();
  pasted.erase(std::remove_if(pasted.begin(), pasted.end(), std::not_fn(requires_pymodbus)), pasted.end());
  EXPECT_GE(pasted.size(), 1U);
  paste_all(std::move(pasted));
}

/// Adds the code spans in a table cell to `codes`, without the escapes of the table syntax.
void add_codes(const std::string& cell, std::set<std::string>& codes) {
  for (auto open = cell.find('`'); open != std::string::npos;
       open = cell.find('`', cell.find('`', open + 1) + 1)) {
    std::string code = cell.substr(open + 1, cell.find('`', open + 1) - open - 1);
    code.erase(std::remove(code.begin(), code.end(), '\\'), code.end());
    codes.insert(code);
  }
}

/// Returns the code spans in the first cell of each table row that begins with a code span, for example
/// `N power on|off`, without the escapes of the table syntax.
std::set<std::string> rows() {
  std::set<std::string> rows;
  for (const std::string& document : documents()) {
    std::ifstream file(document);
    for (std::string line; std::getline(file, line);) {
      if (line.rfind("| `", 0) == 0) {
        add_codes(line.substr(0, line.find(" | ")), rows);
      }
    }
  }
  return rows;
}

/// Returns the cells in the first column of a table in the help. The column is `width` characters wide. The
/// table starts after the line that ends with `heading`, and it ends at the next blank line.
std::vector<std::string> column_of(const std::string& help, const std::string& heading, std::size_t width) {
  std::vector<std::string> cells;
  std::istringstream lines(help.substr(help.find(heading) + heading.size()));
  for (std::string line; std::getline(lines, line) && !line.empty();) {
    const std::string cell = line.substr(2, width);
    if (cell.find_first_not_of(' ') != std::string::npos) {  // otherwise this line continues the previous one
      cells.push_back(cell.substr(0, cell.find_last_not_of(" .") + 1));
    }
  }
  return cells;
}

TEST(Documents, EveryOptionCommandAndFaultHasATableRow) {
  const std::set<std::string> rows_there = rows();
  const auto has_row = [&rows_there](const std::string& beginning) {
    return std::any_of(rows_there.begin(), rows_there.end(), [&](const std::string& row) {
      return row == beginning || row.rfind(beginning + " ", 0) == 0;
    });
  };
  const std::string help = run({simulator_path(), "--help"}).output;
  std::set<std::string> options;
  for (auto at = help.find("\n  --"); at != std::string::npos; at = help.find("\n  --", at + 1)) {
    options.insert(help.substr(at + 3, help.find_first_of(" ,\n", at + 3) - at - 3));
  }
  EXPECT_GE(options.size(), 15U);
  for (const std::string& option : options) {
    EXPECT_TRUE(has_row(option)) << option;
  }
  const std::vector<std::string> commands =
      column_of(run({simulator_path(), "help", "control"}).output, "through all lines.\n\n", 20);
  const std::vector<std::string> faults =
      column_of(run({simulator_path(), "help", "faults"}).output, "[for TIME].\n\n", 22);
  EXPECT_GE(commands.size(), 15U);
  EXPECT_GE(faults.size(), 13U);
  for (const std::string& command : commands) {
    EXPECT_TRUE(has_row(command)) << command;
  }
  for (const std::string& fault : faults) {
    EXPECT_TRUE(has_row(fault)) << fault;
  }
}

}  // namespace
}  // namespace ex9000::system
