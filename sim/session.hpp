// A run of the program: its lines, its control socket and its panel.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/capture/capture.hpp"
#include "sim/control/control.hpp"
#include "sim/control/control_socket.hpp"
#include "sim/greeting.hpp"
#include "sim/made_file.hpp"
#include "sim/panel/panel.hpp"
#include "sim/panel/panel_server.hpp"
#include "sim/running_line.hpp"
#include "sim/runtime/stepper.hpp"
#include "sim/runtime/stop_signals.hpp"
#include "sim/setup.hpp"
#include "sim/watch/watch.hpp"

namespace ex9000::sim {

class Session {
 public:
  using Print = RunningLine::Print;

  /// Opens all that `setup` names. Throws std::invalid_argument or std::runtime_error, one line; what was
  /// opened is given back then, and no file has been made or changed. `print` takes the log and, unless
  /// machines read that, the greeting; `greet` takes it then. `terminal` is where `print` prints, null where
  /// that is none. It and `io` live as long as this object.
  Session(boost::asio::io_context& io, Setup setup, Print print, Print greet, Terminal* terminal);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Makes the files that are missing, prints the greeting, and puts the lines to work as soon as `io` runs,
  /// which is stopped when the time of `setup` is over. Throws likewise; files that it has made go with it
  /// then.
  void start();
  /// Where the lines follow no clock: all that happens in the time of `setup`, unless `io` is stopped.
  void run_as_fast_as_it_can();
  /// Behind either: writes down what was still under way. Throws likewise.
  void finish();

 private:
  [[nodiscard]] bool for_machines() const { return setup_.log == LogFormat::Json; }
  void keep_a_capture();
  void open_line(const LineSetup& line, const Print& print);
  void open_control();
  [[nodiscard]] bool ends() const;
  void end_by_the_clock();
  void make_files_and_greet();
  void open_panel();
  void open_capture();
  void watch_lines();
  void keep_watching();
  Control::Reply carry_out(const std::string& command);
  void answer(const std::string& command, const ControlSocket::Answer& answer);
  void stand_still();

  boost::asio::io_context& io_;
  const Setup setup_;
  Print print_;
  Print greet_;
  std::unique_ptr<Watch> watch_;
  std::vector<std::unique_ptr<RunningLine>> lines_;
  boost::asio::steady_timer end_;
  boost::asio::steady_timer next_look_;
  std::optional<Control> control_;
  StopSignals stop_signals_;
  std::unique_ptr<Stepper> stepper_;  ///< if the lines' time stands still
  std::unique_ptr<ControlSocket> control_socket_;
  std::list<MadeFile> made_;  ///< until it has greeted, they go with it
  std::unique_ptr<Capture> capture_;
  std::unique_ptr<Panel> panel_;
  std::unique_ptr<PanelServer> panel_server_;
};

}  // namespace ex9000::sim
