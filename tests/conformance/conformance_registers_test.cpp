// Plays transcripts on firmware images that are compiled for the host: the drivers are unchanged, and their
// register accesses go to a model of the microcontroller. The model simulates each bit on the line and on the
// EEPROM's wires.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/boards/images_under_test.hpp"
#include "tests/conformance/runs.hpp"
#include "tests/mcu_model/register_target.hpp"

namespace ex9000::registers {
namespace {

/// Folders with transcripts whose results depend on the drivers of the line, of the pins and of the EEPROM:
/// these transcripts test the timing of bytes, baud rates, the state after a reset, edges and levels, and
/// stored settings. The other folders mostly test the contents of replies.
constexpr std::array<const char*, 4> kFoldersOfDrivers{"framing", "init", "inputs", "persistence"};

/// Returns whether the test plays a file on an image. All files run on the images of the LaunchPad
/// (ek-tm4c123gxl), because no emulator supports this board. The images of the lm3s6965evb use the same
/// drivers, so only the files in kFoldersOfDrivers run on them, unless EX9000_TRANSCRIPTS=all is set in the
/// environment.
bool plays(const Image& image, const std::string& file) {
  const char* wanted = std::getenv("EX9000_TRANSCRIPTS");
  const std::string folder = std::filesystem::path(file).parent_path().filename();
  return image.tm4c || (wanted != nullptr && std::string(wanted) == "all") ||
         std::count(kFoldersOfDrivers.begin(), kFoldersOfDrivers.end(), folder) != 0;
}

class ConformanceOnRegisters : public testing::TestWithParam<ImageName> {};

TEST_P(ConformanceOnRegisters, PassesTheTranscriptsOfItsModel) {
  const Image& image = image_of(GetParam().board, GetParam().model);
  std::vector<conformance::Played> runs = conformance::all_runs(conformance::Updates::None);
  const auto others = std::remove_if(runs.begin(), runs.end(), [&image](const conformance::Played& run) {
    return run.transcript.model->designation != image.model || !plays(image, run.transcript.file);
  });
  runs.erase(others, runs.end());
  for (conformance::Played& run : runs) {
    SCOPED_TRACE(conformance::name_of(run));
    RegisterTarget target(image);
    conformance::play_run(run, target);
    BoardBench& bench = target.bench();
    EXPECT_EQ(bench.line.bits_lost, 0U) << "bits sent while driver enable was off";
    EXPECT_EQ(bench.line.let_go_early, 0U);
    EXPECT_EQ(bench.line.let_go_late, 0U);
    EXPECT_FALSE(bench.pins.any_was_shorted());
    EXPECT_EQ(bench.watchdog_resets, 0U);
  }
  conformance::expect_all_steps_passed(image.name().c_str(), runs);
}

INSTANTIATE_TEST_SUITE_P(Images, ConformanceOnRegisters,
                         testing::Values(ImageName{"lm3s6965evb", "EX9055D"},
                                         ImageName{"lm3s6965evb", "EX9043D-M"},
                                         ImageName{"ek-tm4c123gxl", "EX9055D"},
                                         ImageName{"ek-tm4c123gxl", "EX9043D-M"}),
                         name_of);

}  // namespace
}  // namespace ex9000::registers
