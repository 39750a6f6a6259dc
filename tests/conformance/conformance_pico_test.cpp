// Plays the transcripts of the manuals' models on the images for the Pico, in an emulator and in virtual
// time. All these images store their settings in the flash. One model also runs with its settings in an
// EEPROM.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "sim/play/player.hpp"
#include "sim/play/transcript.hpp"
#include "tests/rp2040/pico_target.hpp"
#include "tests/support/core_target.hpp"
#include "tests/support/transcripts.hpp"

namespace ex9000 {
namespace {

constexpr std::array<std::string_view, 8> kModelsOfTheManuals{
    "EX9042D", "EX9042D-M", "EX9043D", "EX9043D-M", "EX9052D", "EX9052D-M", "EX9068D-M", "EX9068AD-M"};

constexpr std::string_view kModelWithEeprom = "EX9043D-M";

struct Played {
  play::Transcript transcript;
  pico::Memory memory;
  play::Result result;
};

/// Returns all runs, the longest ones first, so that the test does not wait for a few long runs at the end.
std::vector<Played> all_runs() {
  std::vector<Played> runs;
  for (const std::string& file : play::transcript_files(EX9000_CONFORMANCE_DIR)) {
    for (play::Transcript& transcript : runner::load_transcripts(file)) {
      const std::string_view model = transcript.model->designation;
      if (model == kModelWithEeprom) {
        runs.push_back({transcript, pico::Memory::Eeprom, {}});
      }
      if (std::count(kModelsOfTheManuals.begin(), kModelsOfTheManuals.end(), model) != 0) {
        runs.push_back({std::move(transcript), pico::Memory::Flash, {}});
      }
    }
  }
  std::stable_sort(runs.begin(), runs.end(), [](const Played& a, const Played& b) {
    return runner::waits_of(a.transcript) > runner::waits_of(b.transcript);
  });
  return runs;
}

/// The boards on which a thread plays its runs.
struct Boards {
  pico::PicoTarget with_flash{pico::Memory::Flash};
  pico::PicoTarget with_eeprom{pico::Memory::Eeprom};
};

void play_on_the_image(Played& run, Boards& boards) {
  try {
    run.result = play::play(run.transcript,
                            run.memory == pico::Memory::Flash ? boards.with_flash : boards.with_eeprom);
  } catch (const std::exception& error) {
    run.result.failure = run.transcript.file + ": " + error.what() + " (" +
                         std::string(run.transcript.model->designation) + ")";
  }
}

TEST(Conformance, TheImagesForThePicoPassEveryTranscriptOfTheManualsModels) {
  std::vector<Played> runs = all_runs();
  std::atomic<std::size_t> next{0};
  std::atomic<std::int64_t> seconds{0};
  std::vector<std::thread> players;
  for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
    players.emplace_back([&] {
      Boards boards;
      for (std::size_t mine = next++; mine < runs.size(); mine = next++) {
        play_on_the_image(runs[mine], boards);
      }
      const auto played = boards.with_flash.played() + boards.with_eeprom.played();
      seconds += std::chrono::ceil<std::chrono::seconds>(played).count();
    });
  }
  for (std::thread& player : players) {
    player.join();
  }
  std::size_t steps = 0;
  std::size_t core_steps = 0;
  for (const Played& run : runs) {
    EXPECT_TRUE(run.result.passed()) << run.result.failure;
    steps += run.result.steps;
    runner::CoreTarget core;
    core_steps += play::play(run.transcript, core).steps;
  }
  EXPECT_EQ(steps, core_steps);
  std::printf("pico: %zu runs, %zu steps, as the core, in %lld s of virtual time\n", runs.size(), steps,
              static_cast<long long>(seconds));
}

}  // namespace
}  // namespace ex9000
