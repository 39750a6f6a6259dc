// What is written down of what is played.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/capture/capture.hpp"
#include "sim/line_record.hpp"
#include "sim/made_file.hpp"
#include "sim/play/onlooker.hpp"
#include "sim/setup.hpp"

namespace ex9000::sim {

class PlayRecord final : public play::Onlooker {
 public:
  using Print = LineRecord::Print;

  /// Log and capture of `writing`. The capture's file is opened when the first run begins; see Capture for
  /// what it throws from then on.
  PlayRecord(Writing writing, Print print);

  // --- play::Onlooker ---
  void begins(const std::string& what) override;
  Faults::Notice joins(Line& line, const std::string& name) override;
  void reached(VirtualTime now) override;
  void ends() override;

 private:
  Writing writing_;
  Print print_;
  std::optional<MadeFile> capture_file_;  ///< kept as soon as a line is in it
  std::unique_ptr<Capture> capture_;
  std::string what_;  ///< is played
  std::vector<std::unique_ptr<LineRecord>> lines_;
};

}  // namespace ex9000::sim
