// One run of the program: its lines, its control socket, its panel and its capture.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/app/running_line/running_line.hpp"
#include "sim/app/running_program/stepper.hpp"
#include "sim/app/setup/setup.hpp"
#include "sim/files_and_ports/files/new_file.hpp"
#include "sim/files_and_ports/ports/stop_signals.hpp"
#include "sim/front_ends/control_socket/control.hpp"
#include "sim/front_ends/control_socket/control_socket.hpp"
#include "sim/front_ends/panel/panel.hpp"
#include "sim/front_ends/panel/panel_server.hpp"
#include "sim/line_monitor/capture/capture.hpp"
#include "sim/line_monitor/log/banner.hpp"

namespace ex9000::sim {

class RunningProgram {
 public:
  using Print = RunningLine::Print;

  /// Opens all that `setup` names, except missing EEPROM files. After an exception, everything is closed, no
  /// new file remains, and existing files are unchanged. `print` gets log, notes and greeting; if the log is
  /// JSON, `greet` gets the greeting. `models`: the content of /models.json. `io` must outlive this.
  RunningProgram(boost::asio::io_context& io, Setup setup, Print print, Print greet,
                 const std::string& models);
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  /// Updates the existing EEPROM files, creates the missing ones, prints the greeting, and starts the lines.
  /// Paced or stepped lines stop `io` after the duration of `setup`, if any. Unless the greeting has been
  /// printed, the destructor removes the new files.
  void start();
  /// Only for Speed::Kind::Max: processes the duration of `setup`, or less if `io` is stopped.
  void run_unpaced();
  /// After `io` or `run_unpaced`: records frames in progress. std::runtime_error: that cannot be written.
  void finish();

 private:
  [[nodiscard]] bool for_machines() const { return setup_.log == LogFormat::Json; }
  void keep_a_capture();
  void open_control();
  [[nodiscard]] bool ends() const;
  void line_begun();
  void end_by_the_clock();
  void begin();
  void make_files_and_greet();
  void open_panel(const std::string& models);
  void open_capture();
  Control::Reply carry_out(const std::string& command);
  void ask(std::size_t line, RequestQueue::Request request);
  void answer(const std::string& command, const ControlSocket::Answer& answer);
  void start_stepped();

  boost::asio::io_context& io_;
  const Setup setup_;
  Print print_;
  Print greet_;
  std::vector<std::unique_ptr<RunningLine>> lines_;
  boost::asio::steady_timer end_;
  std::size_t lines_to_begin_ = 0;
  std::optional<Control> control_;
  StopSignals stop_signals_;
  std::unique_ptr<Stepper> stepper_;  ///< null until `start`, and always null if time is not stepped
  std::unique_ptr<ControlSocket> control_socket_;
  std::list<NewFile> made_;  ///< kept after the greeting has been printed; see NewFile
  std::unique_ptr<Capture> capture_;
  std::unique_ptr<Panel> panel_;
  std::unique_ptr<PanelServer> panel_server_;
};

}  // namespace ex9000::sim
