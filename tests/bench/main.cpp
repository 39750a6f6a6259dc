// Runs the benchmarks. Fails if a benchmark reports an error, for example a missing reply, or if an argument
// is unknown. Durations cannot make the program fail. A benchmark can set the counters `figure`, `at_least`
// and `at_most`. The program reports each `figure` that is below `at_least` or above `at_most`.
#include <benchmark/benchmark.h>

#include <iostream>
#include <limits>
#include <vector>

namespace {

class Reporter final : public benchmark::ConsoleReporter {
 public:
  Reporter() : ConsoleReporter(OO_Tabular) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      failed_ = failed_ || run.error_occurred;
      report_demand(run);
    }
  }
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  static double counter(const Run& run, const char* name, double otherwise) {
    const auto found = run.counters.find(name);
    return found == run.counters.end() ? otherwise : found->second.value;
  }
  static void report_demand(const Run& run) {
    constexpr double kNoLimit = std::numeric_limits<double>::infinity();
    const double figure = counter(run, "figure", 0);
    const double at_least = counter(run, "at_least", -kNoLimit);
    const double at_most = counter(run, "at_most", kNoLimit);
    if (figure < at_least || figure > at_most) {
      std::cerr << run.benchmark_name() << ": the figure is " << figure << "; expected " << at_least << " to "
                << at_most << " if other programs do not use the processors\n";
    }
  }

  bool failed_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 2;
  }
  Reporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return reporter.failed() ? 1 : 0;
}
