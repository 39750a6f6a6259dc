#include "sim/utility/verify/report.hpp"

namespace ex9000::utility {

std::string title_of(const play::Transcript& transcript) {
  return transcript.file + " (" + transcript.run + ")";
}

void Report::played(const play::Transcript& transcript, const play::Result& result) {
  steps_ += result.steps;
  if (result.passed()) {
    ++passed_;
    note("passed        " + title_of(transcript) + ": " + std::to_string(result.steps) + " steps");
  } else {
    ++failed_;
    note("FAILED        " + result.failure);
  }
}

void Report::not_verified(const std::string& why) {
  ++not_verified_;
  note("not verified  " + why);
}

void Report::totals(std::size_t runs) {
  if (this->runs() < runs) {
    note("stopped: " + std::to_string(runs - this->runs()) + " runs not played");
  }
  note(std::to_string(this->runs()) + " runs, " + std::to_string(steps_) +
       " steps: " + std::to_string(passed_) + " passed, " + std::to_string(failed_) + " failed, " +
       std::to_string(not_verified_) + " not verified");
}

}  // namespace ex9000::utility
