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
  /// Without `table`, the folder has no table of models.
  explicit TranscriptFile(const std::string& text, const std::string& table = "") {
    std::string pattern = (std::filesystem::temp_directory_path() / "ex9000-XXXXXX").string();
    directory_ = mkdtemp(pattern.data());
    std::filesystem::create_directory(directory_ + "/folder");
    std::ofstream(path()) << text;
    if (!table.empty()) {
      std::ofstream(directory_ + "/models.table") << table;
    }
  }
  ~TranscriptFile() { std::filesystem::remove_all(directory_); }
  TranscriptFile(const TranscriptFile&) = delete;
  TranscriptFile& operator=(const TranscriptFile&) = delete;
  [[nodiscard]] std::string path() const { return directory_ + "/folder/transcript.txt"; }

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

bool loads(const std::string& text, const std::string& table = "") {
  const TranscriptFile file(text, table);
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
  EXPECT_TRUE(loads("source: x\nmodel: EX9042D A=M\nwith: B=1\n\n> ${B}1{A}\n"));
  EXPECT_FALSE(loads("source: x\nmodel: EX9042D A=M\nwith: A=F\n\n> $01{A}\n"));
  EXPECT_FALSE(loads("source: x\nmodel: EX9042D\n\n> $01{A\n}\n"));
}

/// The names of the runs, each followed by its first step.
std::string runs_of(const std::string& header, const std::string& steps, const std::string& table = "") {
  const TranscriptFile file("source: x\n" + header + "\n" + steps, table);
  std::string runs;
  for (const play::Transcript& transcript : runner::load_transcripts(file.path())) {
    runs += transcript.run + ": " + transcript.steps[0].text + "\n";
  }
  return runs;
}

TEST(Player, PlaysATranscriptOnEachModelWithEachLineOfVariables) {
  EXPECT_EQ(runs_of("model: EX9042D EX9043D A=M\n", "> $01{A}\n"),
            "EX9042D A=M: > $01M\nEX9043D A=M: > $01M\n");
  EXPECT_EQ(runs_of("model: EX9042D C=7\nwith: A=M B={C}\nwith: A=F B=2\n", "> $0{B}{A}\n"),
            "EX9042D C=7 A=M B={C}: > $07M\nEX9042D C=7 A=F B=2: > $02F\n");
  EXPECT_EQ(runs_of("model: EX9042D\npreset: checksum={A}\nmodel: EX9042D\nwith: A=off\n", "> $01M\n"),
            "EX9042D A=off checksum=off: > $01M\nEX9042D A=off: > $01M\n");
  EXPECT_FALSE(loads("source: x\nwith: A=M\n\n> $01M\n"));
  EXPECT_FALSE(loads("source: x\nmodel: EX9042D\nwith: M\n\n> $01M\n"));
}

const std::string kTable =
    "; a comment\nmodel classes A\nEX9042D few,ascii M\nEX9043D ascii F\n\nmodel B\nEX9043D-M 2\n";

TEST(Player, SelectsModelsByTheClassesOfTheTable) {
  EXPECT_EQ(runs_of("models: ascii\n", "> $01{A}\n", kTable), "EX9042D: > $01M\nEX9043D: > $01F\n");
  EXPECT_EQ(runs_of("models: ascii few\n", "> $01{A}\n", kTable), "EX9042D: > $01M\n");
  EXPECT_EQ(runs_of("models: all -EX9043D -few\n", "> $0{B}M\n", kTable), "EX9043D-M: > $02M\n");
  EXPECT_EQ(runs_of("model: EX9043D EX9052D A1=2\n", "> $01M\n", kTable),
            "EX9043D A1=2: > $01M\nEX9052D A1=2: > $01M\n");
  EXPECT_FALSE(loads("source: x\nmodels: few -EX9042D\n\n> $01M\n", kTable));
  EXPECT_FALSE(loads("source: x\nmodels: most\n\n> $01M\n", kTable));
  EXPECT_FALSE(loads("source: x\nmodels: ascii A=F\n\n> $01M\n", kTable));
  EXPECT_FALSE(loads("source: x\nmodels: all\n\n> $01M\n"));
}

TEST(Player, RefusesAnInvalidTable) {
  EXPECT_TRUE(loads(kHeader + "> $01M\n", "model A\nEX9042D-M 1\n"));
  EXPECT_FALSE(loads(kHeader + "> $01M\n", "model A\nEX9042D-M\n"));
  EXPECT_FALSE(loads(kHeader + "> $01M\n", "model A\nEX1 1\n"));
  EXPECT_FALSE(loads(kHeader + "> $01M\n", "model A\nEX9042D-M 1\nEX9042D-M 2\n"));
  EXPECT_FALSE(loads(kHeader + "> $01M\n", "EX9042D-M 1\n"));
}

}  // namespace
}  // namespace ex9000::runner
