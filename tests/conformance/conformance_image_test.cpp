// Plays all transcripts of the manuals' models on their firmware images, on the emulated reference board.
#include <gtest/gtest.h>
#include <sched.h>

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
#include "tests/qemu/emulated_board.hpp"
#include "tests/qemu/image_target.hpp"
#include "tests/qemu/processor.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/core_target.hpp"
#include "tests/support/transcripts.hpp"

namespace ex9000 {
namespace {

constexpr std::array<std::string_view, 8> kModelsOfTheManuals{
    "EX9042D", "EX9042D-M", "EX9043D", "EX9043D-M", "EX9052D", "EX9052D-M", "EX9068D-M", "EX9068AD-M"};

struct Played {
  play::Transcript transcript;
  play::Result result;
};

std::uint64_t pulses_of(const play::Transcript& transcript) {
  std::uint64_t pulses = 0;
  for (const play::Step& step : transcript.steps) {
    const auto* pulse = std::get_if<play::step::Pulse>(&step.action);
    pulses += pulse != nullptr ? pulse->count : 0;
  }
  return pulses;
}

/// Returns the approximate duration of the transcript.
std::chrono::microseconds duration_of(const play::Transcript& transcript) {
  constexpr std::chrono::microseconds kPulse{100};
  return runner::waits_of(transcript) + kPulse * static_cast<std::int64_t>(pulses_of(transcript));
}

/// Returns all runs, the longest ones first, so that the test does not wait for a few long runs at the end.
std::vector<Played> all_runs() {
  std::vector<Played> runs;
  for (const std::string& file : play::transcript_files(EX9000_CONFORMANCE_DIR)) {
    for (play::Transcript& transcript : runner::load_transcripts(file)) {
      if (std::count(kModelsOfTheManuals.begin(), kModelsOfTheManuals.end(), transcript.model->designation) !=
          0) {
        runs.push_back({std::move(transcript), {}});
      }
    }
  }
  std::stable_sort(runs.begin(), runs.end(), [](const Played& a, const Played& b) {
    return duration_of(a.transcript) > duration_of(b.transcript);
  });
  return runs;
}

/// Returns the processors that this program may use.
std::vector<int> processors() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  sched_getaffinity(0, sizeof allowed, &allowed);
  std::vector<int> result;
  for (int i = 0; i < CPU_SETSIZE; ++i) {
    if (CPU_ISSET(i, &allowed)) {
      result.push_back(i);
    }
  }
  return result;
}

void play_on_the_image(Played& run, rig::ImageTarget& target) {
  try {
    run.result = play::play(run.transcript, target);
  } catch (const std::exception& error) {
    run.result.failure = run.transcript.file + ": " + error.what() + " (" +
                         std::string(run.transcript.model->designation) + ")";
  }
}

TEST(Conformance, TheImagesOfTheManualsModelsPassEveryTranscriptForThem) {
  for (const std::string_view model : kModelsOfTheManuals) {
    const system::Finished sum = system::run({"sha256sum", rig::image_of(*find_model(model))});
    ASSERT_EQ(sum.status, 0) << sum.error;
    std::printf("%s", sum.output.c_str());
  }
  std::vector<Played> runs = all_runs();
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> players;
  for (const int processor : processors()) {
    players.emplace_back([&, processor] {
      rig::bind_to_processor(processor);
      rig::ImageTarget target;
      for (std::size_t mine = next++; mine < runs.size(); mine = next++) {
        play_on_the_image(runs[mine], target);
      }
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
  std::printf("images: %zu runs, %zu steps, as the core\n", runs.size(), steps);
}

}  // namespace
}  // namespace ex9000
