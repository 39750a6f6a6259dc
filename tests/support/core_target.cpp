#include "tests/support/core_target.hpp"

namespace ex9000::runner {

void CoreTarget::send(const play::Bytes& bytes) {
  sent_.insert(sent_.end(), bytes.begin(), bytes.end());
  LineTarget::send(bytes);
}

play::Bytes CoreTarget::receive(std::size_t count, std::chrono::milliseconds patience) {
  play::Bytes heard = LineTarget::receive(count, patience);
  note_coverage(heard);
  return heard;
}

play::Bytes CoreTarget::listen(std::chrono::nanoseconds time) {
  play::Bytes heard = LineTarget::listen(time);
  note_coverage(heard);
  return heard;
}

void CoreTarget::note_coverage(const play::Bytes& heard) {
  if (coverage_ != nullptr && !sent_.empty() && module().powered() &&
      sim::hear_each_other(module().mode(), chosen().master().mode())) {
    coverage_->note(module().module(), sent_, heard);
  }
  sent_.clear();
}

}  // namespace ex9000::runner
