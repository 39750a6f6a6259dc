// Plays the transcripts of the manuals' models on the images for the Pico, in an emulator and in virtual
// time. These images store their settings in the flash. For one model, the test also plays the transcripts on
// an image that stores its settings in an EEPROM.
#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "tests/conformance/runs_on_pico.hpp"

namespace ex9000::conformance {
namespace {

TEST(Conformance, TheImagesForThePicoPassEveryTranscriptOfTheManualsModels) {
  std::vector<Played> runs = runs_of_the_manuals(Updates::Images);
  const auto played = play_all_on_pico(runs);
  expect_all_steps_passed("pico", runs);
  std::printf("in %lld s of virtual time\n",
              static_cast<long long>(std::chrono::ceil<std::chrono::seconds>(played).count()));
}

TEST(Conformance, AnImageForThePicoWithAnEepromPassesEveryTranscriptOfItsModel) {
  std::vector<Played> runs = runs_of("EX9043D-M");
  play_all_on_pico(runs, pico::Memory::Eeprom);
  expect_all_steps_passed("pico with an EEPROM", runs);
}

}  // namespace
}  // namespace ex9000::conformance
