// README's examples, pasted. In each section a `sh` block that starts the simulator is one terminal, all
// other `sh` and `python` blocks are another, and what they print is the `text` block behind them. Both are
// in an empty directory but for `boards` and `build`: images are built before.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "tests/system/child_process.hpp"
#include "tests/system/directory.hpp"
#include "tests/system/simulator_process.hpp"

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

std::vector<Section> sections() {
  std::vector<Section> result(1);
  std::ifstream file(EX9000_README);
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("```", 0) == 0) {
      inside = !inside;
      if (inside) {
        result.back().blocks.push_back({line.substr(3), ""});
      }
    } else if (inside) {
      result.back().blocks.back().text += line + "\n";
    } else if (line.rfind("##", 0) == 0) {
      result.push_back({line.substr(line.find(' ') + 1), {}});
    }
  }
  return result;
}

/// README's port may be in use here.
void replace_port(std::string& text, const std::string& port) {
  const std::string written = "5020";
  for (auto at = text.find(written); at != std::string::npos; at = text.find(written, at + port.size())) {
    text.replace(at, written.size(), port);
  }
}

/// `ex9000-sim describe` prints and ends.
bool starts_the_simulator(const Block& block) {
  return block.text.rfind("ex9000-sim ", 0) == 0 && block.text.rfind("ex9000-sim describe", 0) != 0;
}

/// The second terminal: one shell for all blocks of a section, as functions and jobs stay.
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
    std::filesystem::create_symlink(EX9000_PROJECT "/" + folder, directory / folder);
  }
  std::unique_ptr<ChildProcess> simulator;
  Shell shell;
  std::string expected;
  for (const Block& block : section.blocks) {
    if (block.language == "text") {
      expected += block.text;
    } else if (block.language == "sh" && starts_the_simulator(block)) {
      simulator = std::make_unique<ChildProcess>(std::vector<std::string>{"sh", "-c", "exec " + block.text},
                                                 directory.path());
      ASSERT_TRUE(simulator->wait_for("Ctrl-C ends it")) << block.text;
    } else if (block.language == "sh" || block.language == "python") {
      shell.paste(block);
    }
  }
  const Finished finished = shell.run_in(directory.path());
  EXPECT_EQ(finished.output, expected) << finished.error;
}

TEST(Readme, ItsExamplesDoWhatItSays) {
  const std::string port = std::to_string(SimulatorProcess({"EX9042D", "--tcp", "0"}).tcp_port());
  const std::string programs = simulator_path().substr(0, simulator_path().rfind('/'));
  setenv("PATH", (programs + ":" + getenv("PATH")).c_str(), 1);
  int pasted = 0;
  for (Section& section : sections()) {
    SCOPED_TRACE(section.heading);
    bool has_output = false;
    for (Block& block : section.blocks) {
      replace_port(block.text, port);
      has_output = has_output || block.language == "text";
    }
    if (has_output) {
      paste(section);
      ++pasted;
    }
  }
  EXPECT_GE(pasted, 8);
}

}  // namespace
}  // namespace ex9000::system
