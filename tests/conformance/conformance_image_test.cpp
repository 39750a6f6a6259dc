// Plays all transcripts of the manuals' models on their firmware images, on the board lm3s6965evb
// in QEMU.
#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/notation/actions.hpp"
#include "tests/conformance/runs.hpp"
#include "tests/qemu/emulated_board.hpp"
#include "tests/qemu/image_target.hpp"
#include "tests/qemu/processor.hpp"
#include "tests/support/child_process.hpp"

namespace ex9000::conformance {
namespace {

std::uint64_t pulses_of(const play::Transcript& transcript) {
  std::uint64_t pulses = 0;
  for (const play::Step& step : transcript.steps) {
    const sim::Words words = step.words();
    pulses += words[0] == "pulse" ? sim::parse_pulses({words.begin() + 1, words.end()}).count : 0;
  }
  return pulses;
}

/// Returns a rough measure of the length of a run, which only sorts the runs: the waits, and 100 us for each
/// pulse. A pulse itself takes about 8 us of emulated time. Does not count frames, resets and power cycles.
std::chrono::microseconds duration_of(const play::Transcript& transcript) {
  constexpr std::chrono::microseconds kPulse{100};
  return runner::waits_of(transcript) + kPulse * static_cast<std::int64_t>(pulses_of(transcript));
}

/// Returns the processors that this program may use.
std::vector<int> allowed_processors() {
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

TEST(Conformance, TheImagesOfTheManualsModelsPassEveryTranscriptForThem) {
  for (const std::string_view model : kModelsOfTheManuals) {
    const system::Finished sum = system::run({"sha256sum", rig::image_of(*find_model(model))});
    ASSERT_EQ(sum.status, 0) << sum.error;
    std::printf("%s", sum.output.c_str());
  }
  std::vector<Played> runs = runs_of_the_manuals(Updates::None);
  put_longest_first(runs, duration_of);
  std::atomic<std::size_t> next{0};
  const std::vector<int> allowed = allowed_processors();
  in_parallel(static_cast<unsigned>(allowed.size()), [&](unsigned number) {
    rig::bind_to_processor(allowed[number]);
    rig::ImageTarget target;
    for (std::size_t mine = next++; mine < runs.size(); mine = next++) {
      play_run(runs[mine], target);
    }
  });
  expect_all_steps_passed("images", runs);
}

}  // namespace
}  // namespace ex9000::conformance
