// One line of a run: its modules' memories, its ports, its faults and its log.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/capture/capture.hpp"
#include "sim/eeprom_file.hpp"
#include "sim/greeting.hpp"
#include "sim/line.hpp"
#include "sim/line_record.hpp"
#include "sim/made_file.hpp"
#include "sim/pacer.hpp"
#include "sim/runtime/stepped_line.hpp"
#include "sim/setup.hpp"

namespace ex9000::sim {

class RunningLine {
 public:
  using Print = std::function<void(const std::string& line)>;

  /// Opens all that `setup` names. Throws std::invalid_argument or std::runtime_error, one line; what was
  /// opened is given back then, and no file has been made or changed. All arguments live as long as this.
  /// `stepped`: nothing at its ports depends on the wall clock.
  RunningLine(boost::asio::io_context& io, const LineSetup& setup, std::uint64_t seed, LogFormat format,
              bool stepped, Print print);
  RunningLine(const RunningLine&) = delete;
  RunningLine& operator=(const RunningLine&) = delete;

  /// Memories that were there follow what their modules have stored while they came up. Throws likewise.
  void renew_memories();
  /// Those that were not are made, and put behind `made`. Throws likewise.
  void make_missing_memories(std::list<MadeFile>& made);

  /// What is written down of it, `start` being its begin.
  LineRecord& record() { return *record_; }
  /// Makes ready for work.
  void start();
  /// Puts the line to work as soon as `io` runs, so many times faster than the wall clock.
  void follow_the_clock(boost::asio::io_context& io, double speed);
  /// Puts the line to work likewise; its time stands still. `arrived` is called when masters have sent bytes.
  SteppedLine& stand_still(SteppedLine::Arrived arrived);
  /// Nothing is written down of what happens when its modules have been up for longer. Before `start`.
  void end_at(VirtualTime up) { record_->end_at(came_up_ + up); }
  /// All that happens until its modules have been up for so long, at once.
  void run_until(VirtualTime up);
  /// Writes down what was still under way.
  void finish() { record_->finish(); }

  [[nodiscard]] const std::string& name() const { return setup_.name; }
  Line& line() { return *line_; }
  /// Only if it follows the clock.
  Pacer& pacer() { return *pacer_; }
  /// See LinePorts::sent.
  [[nodiscard]] std::uint64_t sent() const {
    return pacer_ ? pacer_->sent() : stepped_ ? stepped_->sent() : 0;
  }
  /// When its modules have been up for so long.
  [[nodiscard]] VirtualTime when_up_for(VirtualTime up) const { return came_up_ + up; }
  [[nodiscard]] const LineIntroduced& introduced() const { return introduced_; }

 private:
  void use_memories();
  void open_ports(boost::asio::io_context& io, bool stepped);
  [[nodiscard]] std::string log_name() const;
  [[nodiscard]] std::string remark(std::size_t index) const;
  void introduce();

  const LineSetup& setup_;
  Print print_;
  std::vector<std::unique_ptr<EepromFile>> memories_;  ///< one a module; null: none
  std::unique_ptr<Line> line_;
  VirtualTime came_up_{0};  ///< its modules, by its time
  LineIntroduced introduced_;
  LinePorts::All ports_;
  std::unique_ptr<LineRecord> record_;
  std::unique_ptr<Pacer> pacer_;          ///< if it follows the clock
  std::unique_ptr<SteppedLine> stepped_;  ///< if its time stands still
};

}  // namespace ex9000::sim
