// One line of a run: the memories of its modules, its ports, its faults, its log and its capture.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "sim/app/running_line/line_record.hpp"
#include "sim/app/running_line/pacer.hpp"
#include "sim/app/running_line/stepped_line.hpp"
#include "sim/app/setup/setup.hpp"
#include "sim/files_and_ports/files/eeprom_file.hpp"
#include "sim/files_and_ports/files/new_file.hpp"
#include "sim/line_monitor/log/banner.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

class RunningLine {
 public:
  using Print = std::function<void(const std::string& line)>;

  /// Opens all that `setup` names, except missing EEPROM files, and starts up the modules. After an
  /// exception, everything is closed, no new file remains, and existing files are unchanged. `io` and `setup`
  /// must outlive this object. `stepped`: the ports do not depend on the wall clock.
  RunningLine(boost::asio::io_context& io, const LineSetup& setup, std::uint64_t seed, LogFormat format,
              bool stepped, const Print& print);
  RunningLine(const RunningLine&) = delete;
  RunningLine& operator=(const RunningLine&) = delete;

  /// Writes what modules have stored during their start to the existing EEPROM files.
  void renew_memories();
  /// Creates the missing EEPROM files and appends them to `made`.
  void make_missing_memories(std::list<NewFile>& made);

  LineRecord& record() { return *record_; }
  /// From now on, modules also store in their EEPROM files. After `make_missing_memories`.
  void start();
  /// Accepts masters. While `io` runs, line time passes at `speed`. `begun`: see Pacer::start.
  void start_paced(double speed, std::function<void()> begun);
  /// Accepts masters. The caller advances the time. `arrived`: see SteppedLine::start.
  SteppedLine& start_stepped(SteppedLine::Arrived arrived);
  /// Until the modules have been up for `up`, without waiting.
  void run_until(VirtualTime up);

  Line& line() { return *line_; }
  /// Only after `start_paced`.
  Pacer& pacer() { return *pacer_; }
  [[nodiscard]] std::uint64_t sent() const { return connected_ ? connected_->sent() : 0; }
  [[nodiscard]] VirtualTime when_up_for(VirtualTime up) const { return came_up_ + up; }
  [[nodiscard]] const LineSummary& summary() const { return summary_; }

 private:
  [[nodiscard]] std::unique_ptr<Port> open(const PortSetup& port, bool stepped);
  void open_ports(bool stepped);
  [[nodiscard]] std::string log_name() const;
  [[nodiscard]] std::string remark(std::size_t index) const;
  void summarize();

  boost::asio::io_context& io_;
  const LineSetup& setup_;
  std::vector<std::unique_ptr<EepromFile>> memories_;  ///< for each module; null if it has no EEPROM file
  std::unique_ptr<Line> line_;
  VirtualTime came_up_{0};  ///< the line's time at which all modules had started up
  LineSummary summary_;
  LinePorts::All ports_;
  std::unique_ptr<LineRecord> record_;
  const LinePorts::Notice note_ = [this](const std::string& text) { record_->note(text); };
  std::unique_ptr<LinePorts> connected_;  ///< null until `start_paced` or `start_stepped`
  std::unique_ptr<Pacer> pacer_;          ///< null until `start_paced`
  std::unique_ptr<SteppedLine> stepped_;  ///< null until `start_stepped`
};

}  // namespace ex9000::sim
