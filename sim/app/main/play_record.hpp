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

  /// Writes the log and the capture that `writing` requests. `print` receives the lines of the log. The first
  /// call of `run_begins` opens the capture file if `writing` names one. This call and all later calls of
  /// member functions may throw the exceptions of Capture.
  PlayRecord(Writing writing, Print print);

  // --- play::PlayObserver ---
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
