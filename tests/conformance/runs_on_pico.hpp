// Plays runs on images for a board with a Pico, in an emulator and in virtual time.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <string_view>
#include <vector>

#include "tests/conformance/runs.hpp"
#include "tests/rp2040/pico_target.hpp"

namespace ex9000::conformance {

/// Plays the runs. Returns the virtual time of the runs in which all steps have passed.
inline std::chrono::nanoseconds play_all_on_pico(std::vector<Played>& runs,
                                                 pico::Memory memory = pico::Memory::Flash) {
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

/// Returns the runs of `all_runs` for a model.
inline std::vector<Played> runs_of(std::string_view designation) {
  std::vector<Played> runs = all_runs(Updates::Images);
  const auto others = std::remove_if(runs.begin(), runs.end(), [designation](const Played& run) {
    return run.transcript.model->designation != designation;
  });
  runs.erase(others, runs.end());
  return runs;
}

}  // namespace ex9000::conformance
