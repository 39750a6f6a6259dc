#include "sim/app/running_program/running_program.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "sim/app/setup/paths_in_use.hpp"
#include "sim/front_ends/panel/face.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::sim {

RunningProgram::RunningProgram(boost::asio::io_context& io, Setup setup, Print print, Print greet,
                               const std::string& models)
    : io_(io), setup_(std::move(setup)), print_(std::move(print)), greet_(std::move(greet)), end_(io) {
  for (const LineSetup& line : setup_.lines) {
    // In the text log, each line of a named line begins with its name; JSON has a key for it.
    const bool as_it_is = line.name.empty() || for_machines();
    const std::string lead = as_it_is ? "" : line.name + ": ";
    lines_.push_back(std::make_unique<RunningLine>(
        io_, line, setup_.seed + lines_.size(), setup_.log.value_or(LogFormat::Text), setup_.speed.stepped(),
        [this, lead](const std::string& text) { print_(lead + text); }));
  }
  open_control();
  open_panel(models);
  open_capture();
}

void RunningProgram::open_control() {
  LinesInUse lines;
  for (const auto& running : lines_) {
    const LineSummary& summary = running->summary();
    lines.push_back(
        {summary.name, running->line(), [&line = *running] { return line.sent(); },
         summary.port("serial") != nullptr,
         [&line = *running](const std::string& text) { line.record().event("command: " + text); }});
  }
  control_.emplace(std::move(lines));
  if (!setup_.control) {
    return;
  }
  with_place(place_of(setup_.places, "control"), [this] {
    control_socket_ = std::make_unique<ControlSocket>(
        io_, *setup_.control,
        [this](const std::string& command, const ControlSocket::Answer& to) { answer(command, to); },
        [this] { io_.stop(); });
  });
}

void RunningProgram::open_panel(const std::string& models) {
  if (!setup_.panel) {
    return;
  }
  panel_ = std::make_unique<Panel>(
      [this](const std::string& command) { return carry_out(command); },
      [this](std::size_t line, RequestQueue::Request request) { ask(line, std::move(request)); },
      setup_.speed.factor);
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    RunningLine& running = *lines_[i];
    panel_->add_line(
        panel_line(running.summary(), running.line(), [&running] { return running.pacer().present(); }));
    running.record().tell(
        [this, i](const Frame& frame) { panel_->hear(i, frame); },
        [this, i](VirtualTime now, const std::string& text) { panel_->note(i, now, text); });
  }
  with_place(place_of(setup_.places, "panel"), [this, &models] {
    panel_server_ = std::make_unique<PanelServer>(io_, setup_.panel->port, models, *panel_);
  });
}

void RunningProgram::open_capture() {
  if (!setup_.capture) {
    return;
  }
  const std::string place = place_of(setup_.places, "capture");
  with_place(place, [this] {
    // The links and the control socket must exist before this check, because it compares inodes.
    refuse_overwriting(*setup_.capture, in_use_by(setup_));
  });
  made_.emplace_back(*setup_.capture, is_there(*setup_.capture));
  capture_ = std::make_unique<Capture>(*setup_.capture, place, [this] { return stop_signals_.arrived(); });
}

/// For the control socket or the panel. Paced lines first reach the present, so the reply is of one time.
Control::Reply RunningProgram::carry_out(const std::string& command) {
  if (stepper_) {
    return control_->carry_out(command);
  }
  for (const auto& running : lines_) {
    running->pacer().reach_present();
  }
  Control::Reply reply = control_->carry_out(command);
  for (const auto& running : lines_) {
    running->pacer().follow();
  }
  return reply;
}

void RunningProgram::ask(std::size_t line, RequestQueue::Request request) {
  RunningLine& running = *lines_[line];
  running.pacer().now([&] { running.line().requests().ask(std::move(request)); });
}

void RunningProgram::answer(const std::string& command, const ControlSocket::Answer& answer) {
  if (stepper_ && Stepper::is_advance(command)) {
    stepper_->advance(command, answer);
  } else {
    answer(carry_out(command));
  }
}

/// Without the wall clock, times have no offset: the capture must not depend on the time of day.
void RunningProgram::keep_a_capture() {
  capture_->begin();
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  for (const auto& running : lines_) {
    const VirtualTime began =
        setup_.speed.paced() ? now - running->line().clock().virtual_now() : VirtualTime(0);
    running->record().keep_in(*capture_, began);
  }
}

void RunningProgram::make_files_and_greet() {
  BannerContent summary;
  summary.panel = panel_server_ ? panel_server_->address() : "";
  summary.control = setup_.control.value_or("");
  for (const auto& running : lines_) {
    running->make_missing_memories(made_);
    summary.lines.push_back(running->summary());
  }
  if (capture_) {
    keep_a_capture();
  }
  (for_machines() ? greet_ : print_)(greeting(summary));
  for (NewFile& file : made_) {
    file.keep();
  }
}

void RunningProgram::start() {
  for (const auto& running : lines_) {
    running->renew_memories();
  }
  begin();
  if (setup_.speed.stepped()) {
    start_stepped();
  }
  if (control_socket_) {
    control_socket_->start();
  }
  if (panel_server_) {
    panel_server_->start();
  }
}

/// The run ends when its time has passed on the line that has begun last.
void RunningProgram::line_begun() {
  if (--lines_to_begin_ == 0 && ends()) {
    end_by_the_clock();
  }
}

/// After all else that can fail in `start`: a failure creates no EEPROM file and keeps an existing capture.
void RunningProgram::begin() {
  make_files_and_greet();
  lines_to_begin_ = lines_.size();
  for (const auto& running : lines_) {
    if (setup_.log) {
      running->record().print_frames();
    }
    if (ends()) {
      running->record().end_at(running->when_up_for(*setup_.lasts));
    }
    running->start();
    if (setup_.speed.paced()) {
      running->start_paced(setup_.speed.factor, [this] { line_begun(); });
    }
  }
}

/// A century or more on the wall clock counts as endless: the clock's range is finite.
bool RunningProgram::ends() const {
  constexpr auto kLongestRun = std::chrono::hours(24 * 365 * 100);
  return setup_.lasts && (!setup_.speed.paced() || *setup_.lasts / setup_.speed.factor < kLongestRun);
}

/// The timer may expire late, but the logs and the capture end exactly at the end of the run.
void RunningProgram::end_by_the_clock() {
  end_.expires_after(std::chrono::duration_cast<VirtualTime>(*setup_.lasts / setup_.speed.factor));
  end_.async_wait([this](const boost::system::error_code& error) {
    if (error) {
      return;
    }
    for (const auto& running : lines_) {
      running->run_until(*setup_.lasts);
    }
    io_.stop();
  });
}

void RunningProgram::start_stepped() {
  std::vector<SteppedLine*> lines;
  for (const auto& running : lines_) {
    lines.push_back(&running->start_stepped([this] {
      if (stepper_) {
        stepper_->arrived();
      }
    }));
  }
  const VirtualTime end = setup_.lasts ? lines_.front()->when_up_for(*setup_.lasts) : kNever;
  stepper_ = std::make_unique<Stepper>(std::move(lines), end, [this] { return stop_signals_.arrived(); });
}

void RunningProgram::run_unpaced() {
  constexpr VirtualTime kStep = std::chrono::milliseconds(100);
  for (VirtualTime now{0}; now < *setup_.lasts && !io_.stopped();) {
    now = std::min(now + kStep, *setup_.lasts);
    for (const auto& running : lines_) {
      running->run_until(now);
    }
    io_.poll();
  }
}

void RunningProgram::finish() {
  for (const auto& running : lines_) {
    running->record().finish();
  }
}

}  // namespace ex9000::sim
