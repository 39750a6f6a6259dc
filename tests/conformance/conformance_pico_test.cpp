// Plays the transcripts of the manuals' models on the images for the Pico, in an emulator and in virtual
// time. These images store their settings in the flash. For one model, the test also plays the transcripts on
// an image that stores its settings in an EEPROM.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <string_view>
#include <vector>

#include "tests/conformance/runs.hpp"
#include "tests/rp2040/pico_target.hpp"

namespace ex9000::conformance {
namespace {

constexpr std::string_view kModelWithEeprom = "EX9043D-M";

/// Plays the runs. Returns the virtual time of the runs in which all steps have passed.
std::chrono::nanoseconds play_all(std::vector<Played>& runs, pico::Memory memory) {
  std::atomic<std::size_t> next{0};
  std::atomic<std::int64_t> played{0};
  put_longest_first(runs, runner::waits_of);
  in_parallel(processors(), [&](unsigned /*number*/) {
    pico::PicoTarget target(memory);
    for (std::size_t mine = next++; mine < runs.size(); mine = next++) {
      play_run(runs[mine], target);
    }
    played += target.played().count();
  });
  return std::chrono::nanoseconds(played);
}

TEST(Conformance, TheImagesForThePicoPassEveryTranscriptOfTheManualsModels) {
  std::vector<Played> runs = runs_of_the_manuals();
  const auto played = play_all(runs, pico::Memory::Flash);
  expect_all_steps_passed("pico", runs);
  std::printf("in %lld s of virtual time\n",
              static_cast<long long>(std::chrono::ceil<std::chrono::seconds>(played).count()));
}

TEST(Conformance, AnImageForThePicoWithAnEepromPassesEveryTranscriptOfItsModel) {
  std::vector<Played> runs = runs_of_the_manuals();
  const auto others = std::remove_if(runs.begin(), runs.end(), [](const Played& run) {
    return run.transcript.model->designation != kModelWithEeprom;
  });
  runs.erase(others, runs.end());
  play_all(runs, pico::Memory::Eeprom);
  expect_all_steps_passed("pico with an EEPROM", runs);
}

}  // namespace
}  // namespace ex9000::conformance
