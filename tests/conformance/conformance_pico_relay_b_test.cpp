// Plays the transcripts of a model on its image for the Pico-Relay-B, through the pins and the automatic
// transceiver of this board.
#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "tests/conformance/runs_on_pico.hpp"

namespace ex9000::conformance {
namespace {

/// EX9000_RELAY_MODEL: another model whose image has been built.
TEST(Conformance, AnImageForThePicoRelayBPassesEveryTranscriptOfItsModel) {
  const char* const wanted = std::getenv("EX9000_RELAY_MODEL");
  std::vector<Played> runs = runs_of(wanted == nullptr ? "EX9068D-M" : wanted);
  play_all_on_pico(runs);
  expect_all_steps_passed("pico-relay-b", runs);
}

}  // namespace
}  // namespace ex9000::conformance
