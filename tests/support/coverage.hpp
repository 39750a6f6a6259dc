// Records which rows of the core's tables, refusals and verdicts the transcripts have reached.
#pragma once

#include <set>
#include <string>

#include "firmware/module.hpp"
#include "sim/app/play/transcript.hpp"

namespace ex9000::runner {

/// Each ASCII command and Modbus function has an id, for example `dcon/read-latches` or `modbus/08`. Each
/// refusal and verdict that the transcripts must reach has an id, for example `refusal/OutOfRange` or
/// `verdict/Foreign`. A row of the register map has an id for each function that can access it, for example
/// `coil/outputs/05` or `register/address/06`. Host OK in Modbus has the id `register/host-ok`.
class Coverage {
 public:
  /// Records the verdict on the bytes `sent`, and the rows or the refusal that they reach. `module` must have
  /// received and processed these bytes. `heard` is its reply. Without a reply, only the rows of host OK and
  /// `#**` count as reached. A request for several rows of the register map reaches only the row of its first
  /// address.
  void note(const Module& module, const play::Bytes& sent, const play::Bytes& heard);

  /// Returns the ids that the transcripts must reach, but have not reached.
  [[nodiscard]] std::set<std::string> missing() const;
  [[nodiscard]] std::size_t reached() const { return reached_.size(); }

 private:
  void note_answered(const Module& module, ex9000::Bytes frame);

  std::set<std::string> reached_;
};

}  // namespace ex9000::runner
