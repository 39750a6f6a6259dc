// A memory for tests that are not about the memory.
#pragma once

#include <algorithm>
#include <vector>

#include "firmware/settings/memory_job.hpp"
#include "firmware/settings/record.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// A memory (hal/memory.hpp) that completes each job at once. At first it is blank.
class InstantMemory {
 public:
  void store(const Model& model, const Settings& settings) {
    record_.fill(0);
    write_record(model, settings, 1, record_);
    size_ = record_.size();
  }

  void start(const MemoryJob& job, Time /*now*/) {
    ++jobs;
    if (!answers) {
      result_ = {false, SettingsSource::NoneGood, false, false};
      return;
    }
    if (job.kind == MemoryJob::Kind::Load) {
      std::copy_n(record_.begin(), size_, job.record.data);
    } else if (job.kind == MemoryJob::Kind::Save) {
      size_ = job.record.size;
      std::copy_n(job.record.data, size_, record_.begin());
    }
    result_ = {true, size_ == 0 ? SettingsSource::Blank : SettingsSource::Good, true, false};
  }
  static bool poll(Time /*now*/) { return false; }
  static bool busy() { return false; }
  [[nodiscard]] MemoryResult result() const { return result_; }

  /// Carries out all jobs of `module`, with a `step` after each.
  template <class Module>
  void serve(Module& module, Time now) {
    while (module.needs_memory()) {
      start(module.memory_job(), now);
      module.memory_done(result_);
      module.step(false, now);
    }
  }

  bool answers = true;
  unsigned jobs = 0;

 private:
  RecordBytes record_{};
  std::size_t size_ = 0;  ///< of the record; 0: the memory is blank
  MemoryResult result_;
};

}  // namespace ex9000
