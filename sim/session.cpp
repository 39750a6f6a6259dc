#include "sim/session.hpp"

#include <algorithm>
#include <utility>

namespace ex9000::sim {

Session::Session(boost::asio::io_context& io, Setup setup, Print print)
    : io_(io), setup_(std::move(setup)), print_(std::move(print)), end_(io) {
  for (const LineSetup& line : setup_.lines) {
    // Of several, each says which it is.
    const Print printed = line.name.empty() ? print_ : [this, &line](const std::string& text) {
      print_(line.name + ": " + text);
    };
    lines_.push_back(std::make_unique<RunningLine>(io_, line, setup_.seed + lines_.size(), printed));
  }
  open_control();
}

Session::~Session() = default;

void Session::open_control() {
  if (!setup_.control) {
    return;
  }
  std::vector<Control::ControlledLine> lines;
  for (const auto& running : lines_) {
    lines.push_back({running->name(), running->line()});
  }
  control_.emplace(std::move(lines));
  control_socket_ = std::make_unique<ControlSocket>(
      io_, *setup_.control, [this](const std::string& command) { return carry_out(command); },
      [this] { io_.stop(); });
}

/// All lines show the same time to whoever looks at one.
Control::Reply Session::carry_out(const std::string& command) {
  Control::Reply reply;
  std::function<void()> action = [&] { reply = control_->carry_out(command); };
  for (const auto& running : lines_) {
    action = [&pacer = running->pacer(), action] { pacer.now(action); };
  }
  action();
  return reply;
}

/// All or none.
void Session::make_missing_memories() {
  std::vector<const EepromFile*> made;
  try {
    for (const auto& running : lines_) {
      running->make_missing_memories(made);
    }
  } catch (...) {
    for (const EepromFile* file : made) {
      file->discard();
    }
    throw;
  }
}

void Session::start() {
  for (const auto& running : lines_) {
    running->renew_memories();
  }
  make_missing_memories();
  Introduced introduced;
  introduced.control = setup_.control.value_or("");
  for (const auto& running : lines_) {
    introduced.lines.push_back(running->introduced());
  }
  print_(greeting(introduced));
  for (const auto& running : lines_) {
    running->start(setup_.log);
    if (setup_.speed) {
      running->follow_the_clock(io_, *setup_.speed);
    }
  }
  if (control_socket_) {
    control_socket_->start();
  }
  if (setup_.speed && setup_.lasts) {
    end_.expires_after(std::chrono::duration_cast<VirtualTime>(*setup_.lasts / *setup_.speed));
    end_.async_wait([this](const boost::system::error_code& /*error*/) { io_.stop(); });
  }
}

void Session::run_as_fast_as_it_can() {
  constexpr VirtualTime kStep = std::chrono::milliseconds(100);
  for (VirtualTime now{0}; now < *setup_.lasts && !io_.stopped();) {
    now = std::min(now + kStep, *setup_.lasts);
    for (const auto& running : lines_) {
      running->run_until(now);
    }
    io_.poll();
  }
}

}  // namespace ex9000::sim
