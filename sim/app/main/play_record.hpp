// Writes the log and the capture of files that are played.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/app/play/play_observer.hpp"
#include "sim/app/running_line/line_record.hpp"
#include "sim/app/setup/setup.hpp"
#include "sim/files_and_ports/files/new_file.hpp"
#include "sim/line_monitor/capture/capture.hpp"

namespace ex9000::sim {

class PlayRecord final : public play::PlayObserver {
 public:
  using Print = LineRecord::Print;

  /// `print` gets the lines of the log. The first `run_begins` opens the capture that `writing` names; it and
  /// all later calls may throw what Capture throws.
  PlayRecord(Writing writing, Print print);

  void run_begins(const std::string& what) override;
  Faults::Notice line_started(Line& line, const std::string& name) override;
  void time_reached(VirtualTime now) override;
  void run_ends() override;

 private:
  Writing writing_;
  Print print_;
  std::optional<NewFile> capture_file_;  ///< removes a new capture file if no line has started
  std::unique_ptr<Capture> capture_;
  std::string what_;  ///< the file that is played and, for a transcript, the model
  std::vector<std::unique_ptr<LineRecord>> lines_;
};

}  // namespace ex9000::sim
