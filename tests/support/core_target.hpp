// The core in virtual time as a transcript's target, with a note of what transcripts reach.
#pragma once

#include "sim/play/bus_target.hpp"
#include "tests/support/coverage.hpp"

namespace ex9000::runner {

using play::Bytes;

/// A module and a master on a virtual bus.
class CoreTarget final : public play::BusTarget {
 public:
  /// What the transcripts reach is noted in `coverage`, where there is one.
  explicit CoreTarget(Coverage* coverage = nullptr) : coverage_(coverage) {}

  /// Its terminals: inputs that the model lacks can be wired up too, which a transcript has no words for.
  using play::BusTarget::module;

  void send(const Bytes& bytes) override;
  Bytes receive(std::size_t count, std::chrono::milliseconds patience) override;
  Bytes listen(std::chrono::nanoseconds time) override;

 private:
  void note_coverage(const Bytes& heard);

  Coverage* coverage_;
  Bytes sent_;  ///< since coverage was last noted
};

}  // namespace ex9000::runner
