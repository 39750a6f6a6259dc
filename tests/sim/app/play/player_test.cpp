// Tests that the player reports wrong, missing and unexpected replies, and wrong states of the outputs and
// the LED. Also tests that `load_transcripts` rejects invalid files.
#include "sim/app/play/player.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "tests/support/core_target.hpp"
#include "tests/support/transcripts.hpp"

namespace ex9000::runner {
namespace {

class TranscriptFile {
 public:
  explicit TranscriptFile(const std::string& text) {
    std::string pattern = (std::filesystem::temp_directory_path() / "ex9000-XXXXXX").string();
    directory_ = mkdtemp(pattern.data());
    std::ofstream(path()) << text;
  }
  ~TranscriptFile() { std::filesystem::remove_all(directory_); }
  TranscriptFile(const TranscriptFile&) = delete;
  TranscriptFile& operator=(const TranscriptFile&) = delete;
  [[nodiscard]] std::string path() const { return directory_ + "/transcript.txt"; }

 private:
  std::string directory_;
};

const std::string kHeader = "source: wire.md 4\nmodel: EX9042D-M\npreset: protocol=ascii\n\n";
const std::string kModbusHeader = "source: wire.md 7\nmodel: EX9042D-M\n\n";

bool passes(const std::string& text) {
  const TranscriptFile file(text);
  CoreTarget target;
  return play::play(runner::load_transcripts(file.path()).front(), target).passed();
}

bool loads(const std::string& text) {
  const TranscriptFile file(text);
  try {
    return !runner::load_transcripts(file.path()).empty();
  } catch (const std::invalid_argument&) {
    return false;
  }
}

TEST(Player, PassesACorrectTranscript) {
  EXPECT_TRUE(passes(kHeader + "> $01M\n< !019042M\n> $02M\nsilence\noutputs 0000\nled on\n"));
  EXPECT_TRUE(passes(kModbusHeader + "=> 01 01 00 00 00 0D\n<= 01 01 02 00 00\n"));
}

TEST(Player, ReportsAWrongOrMissingReplyAndAWrongStateOfOutputsOrLed) {
  EXPECT_FALSE(passes(kHeader + "> $01M\n< !019042\n"));
  EXPECT_FALSE(passes(kHeader + "> $01M\n< !019042MM\n"));
  EXPECT_FALSE(passes(kHeader + "> $02M\n< !029042M\n"));
  EXPECT_FALSE(passes(kHeader + "outputs 0001\n"));
  EXPECT_FALSE(passes(kHeader + "led flashing\n"));
}

TEST(Player, ReportsAnUnexpectedReply) {
  EXPECT_FALSE(passes(kHeader + "> $01M\n> $02M\nsilence\n"));
  EXPECT_FALSE(passes(kHeader + "> $01M\nsilence\n"));
  EXPECT_FALSE(passes(kHeader + "> $01M\nwait 100ms\n"));
  EXPECT_FALSE(passes(kHeader + "> $01M\npower-cycle\n> $012\n< !01400600\n"));
  EXPECT_FALSE(passes(kHeader + "> $01M\nreset\n> $012\n< !01400600\n"));
  EXPECT_FALSE(passes(kHeader + "> $01M\n"));
  EXPECT_FALSE(passes(kHeader + "> $01M\n< !01\n"));
  EXPECT_FALSE(passes(kModbusHeader + "=> 01 01 00 00 00 0D\n=> 02 01 00 00 00 0D\nsilence\n"));
  EXPECT_FALSE(passes(kModbusHeader + "=> 01 01 00 00 00 0D\n"));
}

TEST(Player, RefusesAFileWithAnInvalidStepOrHeader) {
  EXPECT_TRUE(loads(kHeader + "outputs FFFF\n"));
  EXPECT_FALSE(loads(kHeader + "outputs 10000\n"));
  EXPECT_FALSE(loads(kHeader + "input 0 on\n"));
  EXPECT_FALSE(loads(kHeader + "pulse 9\n"));
  EXPECT_FALSE(loads(kHeader + "sleep 1s\n"));
  EXPECT_FALSE(loads(kHeader + "wait 1\n"));
  EXPECT_FALSE(loads(kHeader + "=> 01 0\n"));
  EXPECT_FALSE(loads(kHeader + "baud 0\n"));
  EXPECT_FALSE(loads("source: x\nmodel: EX9042D\npreset: address=-1\n\n> $01M\n"));
  EXPECT_FALSE(loads("source: x\nmodel: EX9042D\npreset: baud=0\n\n> $01M\n"));
  EXPECT_FALSE(loads("model: EX9042D\n\n> $01M\n"));
  EXPECT_FALSE(loads("source: x\n\n> $01M\n"));
  EXPECT_FALSE(loads("source: x\nmodel: EX1\n\n> $01M\n"));
}

TEST(Player, RefusesAVariableThatIsNotDefinedOrIsDefinedTwice) {
  EXPECT_TRUE(loads("source: x\nmodel: EX9042D A=M\n\n> $01{A}\n"));
  EXPECT_FALSE(loads("source: x\nmodel: EX9042D A=M\n\n> $01{B}\n"));
  EXPECT_FALSE(loads("source: x\nmodel: EX9042D A=M A=F\n\n> $01{A}\n"));
}

}  // namespace
}  // namespace ex9000::runner
