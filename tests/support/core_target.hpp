// A transcript target: the core in virtual time. It can record which refusals, which verdicts and which rows
// of the core's tables the transcripts reach.
#pragma once

#include "sim/app/play/line_target.hpp"
#include "tests/support/coverage.hpp"

namespace ex9000::runner {

using play::Bytes;

/// A module and a master on a virtual bus.
class CoreTarget final : public play::LineTarget {
 public:
  /// Records in `coverage` what the transcripts reach. Records nothing if `coverage` is null.
  explicit CoreTarget(Coverage* coverage = nullptr) : coverage_(coverage) {}

  /// Returns the module with its terminals. The module also has terminals for inputs that the model does not
  /// have. A transcript cannot set these inputs.
  using play::LineTarget::module;

  void send(const Bytes& bytes) override;
  Bytes receive(std::size_t count, std::chrono::milliseconds patience) override;
  Bytes listen(std::chrono::nanoseconds time) override;

 private:
  void note_coverage(const Bytes& heard);

  Coverage* coverage_;
  Bytes sent_;  ///< bytes sent since the last call of `receive` or `listen`
};

}  // namespace ex9000::runner
