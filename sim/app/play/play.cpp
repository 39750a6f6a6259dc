#include "sim/app/play/play.hpp"

#include <vector>

#include "sim/app/play/line_target.hpp"
#include "sim/app/play/model_table.hpp"
#include "sim/app/play/player.hpp"
#include "sim/app/play/rehearsal.hpp"
#include "sim/app/play/transcript.hpp"
#include "sim/app/setup/paths_in_use.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::play {

namespace {

using sim::fail;

void check(const Transcript& transcript, const std::optional<sim::Setup>& bus) {
  if (transcript.model == nullptr && !bus) {
    fail(transcript.file + ": names no model; add modules or a bus file to the command line");
  }
  if (transcript.model != nullptr && bus) {
    fail(transcript.file + ": names its models; leave out the modules or the bus file");
  }
}

/// Before the capture starts: it must not be a file that is played, its table of models, or one of the bus.
void check_capture_path(const Task& task, const std::vector<Transcript>& all) {
  if (!task.writing.capture) {
    return;
  }
  std::vector<sim::InUse> read = task.bus ? sim::in_use_by(*task.bus) : std::vector<sim::InUse>();
  for (const Transcript& transcript : all) {
    read.push_back({"the file of steps", transcript.file});
    if (const std::string table = table_path_for(transcript.file); !table.empty()) {
      read.push_back({"the table of models", table});
    }
  }
  sim::with_place("--capture: ", [&] { sim::refuse_overwriting(*task.writing.capture, read); });
}

}  // namespace

bool play(const Task& task, const std::function<void(const std::string& line)>& print,
          PlayObserver& observer) {
  const std::vector<Transcript> all = load_all(task.path);
  const Memories memories = task.bus ? read_memories(*task.bus) : Memories();
  for (const Transcript& transcript : all) {
    check(transcript, task.bus);
    if (task.bus) {
      LineTarget bus(*task.bus, memories);
      rehearse(transcript, bus);
    }
  }
  check_capture_path(task, all);
  std::size_t steps = 0;
  std::size_t failed = 0;
  for (const Transcript& transcript : all) {
    const std::string who = transcript.model == nullptr ? "" : " (" + transcript.run + ")";
    observer.run_begins(transcript.file + who);
    LineTarget target = task.bus ? LineTarget(*task.bus, memories, &observer) : LineTarget(&observer);
    const Result result = play(transcript, target);
    observer.run_ends();
    steps += result.steps;
    failed += result.passed() ? 0U : 1U;
    print(result.passed()
              ? "passed  " + transcript.file + who + ": " + std::to_string(result.steps) + " steps"
              : "FAILED  " + result.failure);
  }
  print(std::to_string(all.size()) + (all.size() == 1 ? " run, " : " runs, ") + std::to_string(steps) +
        " steps, " + std::to_string(failed) + " failed");
  return failed == 0;
}

}  // namespace ex9000::play
