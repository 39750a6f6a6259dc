// Plays firmware/set-up-a-line.md: its simulated modules, its commands, and what these print.
//
// A line `$ ex9000 ...` is a command; what it prints follows, on standard output and then on standard error,
// without progress. A line `$ tell ...` is an action of the control socket. During `verify`, the other
// modules are off, and the rig is one of this test.
#include <gtest/gtest.h>

#include <regex>

#include "sim/utility/verify/verify.hpp"
#include "tests/firmware/update/messages.hpp"
#include "tests/sim/utility/plant.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/in_repository.hpp"

namespace ex9000::utility {
namespace {

const std::string kDocument = "firmware/set-up-a-line.md";

/// Version 01.07 for a model on a Pico.
std::string update_for(const char* model) {
  const update::Buffer image = update::image_of(5000);
  update::Buffer file = update::info_of(image, 0x0107);
  const update::Signature signature = update::signature_of(*find_model(model), "pico");
  std::copy(signature.begin(), signature.end(), file.begin());
  for (std::uint32_t offset = 0; offset < image.size(); offset += update::kBlockSize) {
    const update::Buffer block = update::block_of(image, offset);
    file.insert(file.end(), block.begin(), block.end());
  }
  return {file.begin(), file.end()};
}

class PlantRig final : public Rig {
 public:
  PlantRig(Plant& plant, std::string module) : plant_(plant), module_(std::move(module)) {}
  std::string ask(const std::string& request) override { return plant_.act(module_ + " " + request); }

 private:
  Plant& plant_;
  std::string module_;
};

class Document {
 public:
  explicit Document(const sim::Words& modules) : plant_(modules), size_(modules.size()) {
    for (const char* model : {"EX9042D-M", "EX9052D-M"}) {
      system::write_file(directory_ / (std::string(model) + ".ex9fw"), update_for(model));
    }
  }

  /// What a line prints.
  std::string run(const std::string& line) {
    if (line.rfind("$ tell ", 0) == 0) {
      const sim::Words words = sim::words_of(std::regex_replace(line.substr(7), std::regex("'"), ""));
      plant_.act(sim::joined(words));
      if (words.back() != "off" || words[1] == "power") {
        plant_.wait();
      }
      return "";
    }
    sim::Words words = sim::words_of(line.substr(2));
    EXPECT_EQ(words[0], "ex9000");
    for (std::string& word : words) {
      if (word.find(".ex9fw") != std::string::npos || word.find(".yaml") != std::string::npos) {
        word.insert(0, directory_.path() + "/");
      }
    }
    if (words[1] == "verify") {
      EXPECT_TRUE(verify(words)) << plant_.output();
    } else {
      EXPECT_EQ(plant_.run({words.begin() + 1, words.end()}), 0) << line << "\n" << plant_.error();
    }
    return std::regex_replace(plant_.output() + plant_.error(),
                              std::regex("[^\n]*: [0-9]+ %\n|" + directory_.path() + "/"), "");
  }

 private:
  /// ex9000 verify PORT MODULE FILE --rig ./rig --report FILE
  bool verify(const sim::Words& words) {
    switch_others(words[3], "off");
    plant_.clear();
    Environment environment = plant_.environment();
    PlantRig rig(plant_, words[3]);
    const std::string address = words[3];
    const bool good = utility::verify(environment,
                                      {{},
                                       parse_addressee(address),
                                       play::load_all(in_repository(words[4])),
                                       nullptr,
                                       directory_ / words.back()},
                                      rig);
    switch_others(words[3], "on");
    return good;
  }

  void switch_others(const std::string& module, const std::string& state) {
    for (std::size_t number = 1; number <= size_; ++number) {
      if (std::to_string(number) != module) {
        plant_.act(std::to_string(number) + " power " + state);
      }
    }
    plant_.wait();
  }

  Plant plant_;
  std::size_t size_;
  system::Directory directory_;
};

TEST(Document, ShowsWhatItsCommandsPrint) {
  const std::string text = system::bytes_of_file(in_repository(kDocument));
  const std::size_t begin = text.find("ex9000-sim ") + std::string("ex9000-sim ").size();
  sim::Words modules = sim::words_of(
      std::regex_replace(text.substr(begin, text.find("--control") - begin), std::regex("\\\\\n"), " "));
  Document document(modules);
  std::string shown;
  std::string actual;
  bool in_block = false;
  unsigned commands = 0;
  for (const std::string& line : sim::parts_of(text, '\n')) {
    if (line.rfind("```", 0) == 0) {
      in_block = line == "```text";
      continue;
    }
    if (!in_block) {
      continue;
    }
    shown += line + "\n";
    commands += line.rfind("$ ex9000 ", 0) == 0 ? 1 : 0;
    if (line.rfind("$ ", 0) == 0) {
      actual += line + "\n" + document.run(line);
    }
  }
  EXPECT_EQ(actual, shown) << actual;
  EXPECT_LE(commands, 15U);
}

}  // namespace
}  // namespace ex9000::utility
