// Records which rows of the core's tables, refusals and verdicts the transcripts have reached.
#pragma once

#include <set>
#include <string>

#include "firmware/module.hpp"
#include "sim/app/play/transcript.hpp"

namespace ex9000::runner {

/// Each row, refusal and verdict has an id, for example `dcon/read-latches`, `modbus/08`, `coil/outputs/05`,
/// `register/address/06`, `refusal/OutOfRange` or `verdict/Foreign`.
class Coverage {
 public:
  /// Records the verdict on the bytes `sent`, and the row or the refusal that they reach. `module` must have
  /// received and processed them. `heard` is its reply. Without a reply, only the rows of host OK and `#**`
  /// count as reached.
  void note(const Module& module, const play::Bytes& sent, const play::Bytes& heard);

  /// Returns the ids that a master can reach, but that no transcript has reached.
  [[nodiscard]] std::set<std::string> missing() const;
  [[nodiscard]] std::size_t reached() const { return reached_.size(); }

 private:
  void note_answered(const Module& module, ex9000::Bytes frame);

  std::set<std::string> reached_;
};

}  // namespace ex9000::runner
