// Which rows of the core's tables and which refusals the transcripts have reached.
#pragma once

#include <set>
#include <string>

#include "firmware/module.hpp"
#include "sim/play/transcript.hpp"

namespace ex9000::runner {

/// Every row and every kind of refusal has an id: `dcon/read-latches`, `modbus/08`, `coil/outputs/05`,
/// `register/address/06`, `refusal/OutOfRange`, `verdict/Foreign`.
class Coverage {
 public:
  /// `sent` was put on the line at the module's rate, `module` has dealt with it, and `heard` is its answer.
  /// What is not answered counts only where silence is the answer.
  void note(const Module& module, const play::Bytes& sent, const play::Bytes& heard);

  /// Ids that can be reached by what a master may send, and were not.
  [[nodiscard]] std::set<std::string> missing() const;
  [[nodiscard]] std::size_t reached() const { return reached_.size(); }

 private:
  void note_answered(const Module& module, ex9000::Bytes frame);

  std::set<std::string> reached_;
};

}  // namespace ex9000::runner
