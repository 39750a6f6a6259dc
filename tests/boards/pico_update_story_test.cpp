// The story of an update, with the program ex9000 and an image in the emulator: firmware/update-a-module.md
// shows what it prints.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <regex>
#include <sstream>

#include "sim/app/play/modbus_frame.hpp"
#include "tests/boards/pico_image.hpp"
#include "tests/firmware/update/messages.hpp"
#include "tests/sim/utility/target_line.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/in_repository.hpp"

namespace ex9000::pico {
namespace {

using utility::Data;

constexpr std::uint32_t kBaud = 115200;
constexpr unsigned kInput = 3;
constexpr const char* kFile = "EX9052D-M.ex9fw";

/// The update file that tests/boards/next-version builds.
Data next_version() {
  const std::string file = system::bytes_of_file(in_repository("build/next/build/pico/") + kFile);
  return {file.begin(), file.end()};
}

/// An update whose image hangs when it starts: its reset handler is a branch to itself.
Data broken_version() {
  constexpr std::size_t kResetHandlerAt = 4;
  constexpr std::uint16_t kBranchToItself = 0xE7FE;
  const Data file = next_version();
  Data image;
  for (std::size_t at = update::kInfoSize; at < file.size(); at += update::kBlockMessageSize) {
    const auto block = file.begin() + static_cast<std::ptrdiff_t>(at + update::kBlockDataAt);
    image.insert(image.end(), block, block + update::kBlockSize);
  }
  image.resize(ex9000::Bytes{file.data(), file.size()}.double_word(update::kLengthAt));
  const auto handler = ex9000::Bytes{image.data(), image.size()}.low_byte_first_16(kResetHandlerAt) - 1U;
  image[handler] = static_cast<std::uint8_t>(kBranchToItself);
  image[handler + 1] = static_cast<std::uint8_t>(kBranchToItself >> 8U);

  Data broken = update::info_of(image, 0x0300);
  std::copy_n(file.begin(), update::kSignatureSize, broken.begin());
  for (std::uint32_t offset = 0; offset < image.size(); offset += update::kBlockSize) {
    const Data block = update::block_of(image, offset);
    broken.insert(broken.end(), block.begin(), block.end());
  }
  return broken;
}

/// What happens on the line beside the program ex9000, through a gateway that it shares with another master.
struct Story {
  PicoBench& bench;
  unsigned cut_after = 0;      ///< the power fails during this block; 0: never
  unsigned blocks = 0;         ///< that ex9000 has sent in this run
  nanoseconds first_block{0};  ///< when it has sent the first one
  nanoseconds last_block{0};
  bool may_reset = false;  ///< the module has been activated
  unsigned pulses = 0;     ///< since the start of the module
  unsigned all_pulses = 0;
  unsigned polls = 0;
};

/// The other master polls the counter before each request of ex9000. The input pulses while the module works
/// on one.
class SharedLine final : public utility::Connection {
 public:
  explicit SharedLine(Story& story) : story_(story), bench_(story.bench) {}

  void set_mode(hal::SerialMode /*mode*/) override {}
  void send(const Data& frame) override {
    if (bench_.powered()) {
      poll();
    }
    bench_.send(frame);
    const ex9000::Bytes bytes{frame.data(), frame.size()};
    story_.may_reset = story_.may_reset || (frame[1] == 6 && bytes.word(2) == 0x1013);
    if (frame[1] == 0x10 && bytes.word(2) == 0x2000) {
      block();
    }
    if (bench_.powered()) {
      pulse();
    }
  }
  Data receive(utility::Time patience) override {
    return bench_.receive(1, std::max(patience, utility::Time(0)));
  }
  utility::Time now() override { return bench_.now(); }

 private:
  void block() {
    story_.last_block = now();
    if (++story_.blocks == 1) {
      story_.first_block = now();
    }
    if (story_.blocks == story_.cut_after) {
      bench_.run_for(std::chrono::microseconds(300));  // the page is being programmed
      bench_.power(false);
    }
  }

  void pulse() {
    constexpr unsigned kPulses = 5;
    bench_.pulse_input(kInput, kPulses, std::chrono::microseconds(100));
    story_.pulses += kPulses;
    story_.all_pulses += kPulses;
  }

  void poll() {
    bench_.send(with_crc({5, 3, 0, kInput, 0, 1}));
    const Data reply = bench_.receive(7, milliseconds(20));
    bench_.run_for(milliseconds(2));
    const bool right = reply.size() == 7 && with_crc({reply.begin(), reply.end() - 2}) == reply;
    EXPECT_TRUE(right || story_.may_reset);
    if (right) {
      const unsigned counted = ex9000::Bytes{reply.data(), reply.size()}.word(3);
      story_.pulses = story_.may_reset && counted == 0 ? 0 : story_.pulses;
      EXPECT_EQ(counted, story_.pulses) << "an edge is lost";
      ++story_.polls;
    }
  }

  Story& story_;
  PicoBench& bench_;
};

class PicoUpdateStory : public PicoImage {
 protected:
  PicoUpdateStory() {
    const Model& model = *find_model("EX9052D-M");
    Settings settings = Settings::factory(model);
    settings.address = 5;
    settings.baud_code = kLastBaudCode;
    settings.name = Name("PUMP 7");
    settings.watchdog_enabled = true;
    settings.fed_by_requests = true;
    bench_.begin_anew(model, &settings);
    bench_.set_baud(kBaud);
    start();
  }

  void start() {
    bench_.power(true);
    bench_.come_up();
    bench_.heard();
    story_.pulses = 0;
  }

  /// Runs the program. `file`: for people.
  int run(std::vector<std::string> words, const std::string& file = "") {
    out_ << "$ ex9000";
    for (const std::string& word : words) {
      out_ << " " << word;
    }
    out_ << file << "\n";
    std::replace(words.begin(), words.end(), std::string(kFile), directory_ / kFile);
    story_.blocks = 0;
    story_.may_reset = false;
    const int status = program_.run(words);
    out_ << program_.output();
    return status;
  }
  int update(const Data& file, const std::string& what) {
    system::write_file(directory_ / kFile, {file.begin(), file.end()});
    return run({"update", "port", "5", kFile, "--baud", "115200", "--wait"}, "  # " + what);
  }

  Story story_{bench_};
  utility::Program program_{
      [this](hal::SerialMode /*mode*/) { return std::make_unique<SharedLine>(story_); }};
  system::Directory directory_;
  std::ostringstream out_;
};

std::string without_digits(const std::string& text) {
  return std::regex_replace(text, std::regex("[0-9]+"), "N");
}

TEST_F(PicoUpdateStory, IsAsTheDocumentShows) {
  const auto scan = [this] {
    EXPECT_EQ(run({"scan", "port", "--fast", "--baud", "115200", "--format", "8N1"}), 0);
  };
  scan();
  story_.cut_after = 100;
  EXPECT_EQ(update(next_version(), "D02.34; the power fails during block 100"), 1);
  start();
  story_.cut_after = 0;
  EXPECT_EQ(update(next_version(), "D02.34 again"), 0);
  const unsigned blocks = story_.blocks;
  const auto took = std::chrono::duration_cast<std::chrono::seconds>(story_.last_block - story_.first_block);
  EXPECT_LT(blocks, 180U) << "it has not continued";
  scan();
  EXPECT_EQ(update(broken_version(), "D03.00, which hangs when it starts"), 1);
  scan();
  out_ << "The second transfer had " << blocks << " blocks and took " << took.count() << " s. Input "
       << kInput << " had " << story_.all_pulses << " pulses;\nall " << story_.polls
       << " replies to the other master had the right count.\n";

  std::cout << out_.str();
  const std::string document =
      without_digits(system::bytes_of_file(in_repository("firmware/update-a-module.md")));
  EXPECT_NE(document.find(without_digits(out_.str())), std::string::npos);
  EXPECT_NE(out_.str().find("5: runs D02.34, confirmed"), std::string::npos);
  const std::string shown = out_.str().substr(out_.str().rfind("$ ex9000 scan"));
  EXPECT_NE(shown.find("EX9052D-M 'PUMP 7'  D02.34"), std::string::npos);
}

}  // namespace
}  // namespace ex9000::pico
