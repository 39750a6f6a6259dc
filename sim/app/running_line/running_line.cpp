#include "sim/app/running_line/running_line.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sim/app/setup/line_factory.hpp"
#include "sim/files_and_ports/ports/pty_port.hpp"
#include "sim/files_and_ports/ports/serial_port.hpp"
#include "sim/files_and_ports/ports/tcp_port.hpp"
#include "sim/front_ends/modbus_tcp/modbus_tcp_server.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/system_error.hpp"

namespace ex9000::sim {

namespace {

Pace pace_of(const LineSetup& setup, double speed) {
  Pace pace;
  if (setup.instant) {
    pace.host_latency = VirtualTime(0);
    pace.lead = std::chrono::microseconds(200);  // an immediate reply does not wait for the wall clock
  }
  pace.keep_frames_apart = !setup.strict_gaps;
  pace.speed = speed;
  return pace;
}

}  // namespace

RunningLine::RunningLine(boost::asio::io_context& io, const LineSetup& setup, std::uint64_t seed,
                         LogFormat format, bool stepped, const Print& print)
    : io_(io), setup_(setup) {
  for (const ModuleSpec& module : setup.modules) {
    with_place(place_of(module.places, "eeprom"), [&] {
      memories_.push_back(module.eeprom.empty() ? nullptr : std::make_unique<EepromFile>(module.eeprom));
    });
  }
  line_ = make_line(setup, [this](std::uint8_t byte, ByteStatus /*status*/) {
    if (connected_) {
      connected_->hear(byte);
    }
  });
  for (std::size_t i = 0; i < line_->size(); ++i) {
    if (memories_[i] != nullptr && memories_[i]->found()) {
      line_->module(i).memory().contents() = *memories_[i]->found();
    }
  }
  line_->come_up();
  came_up_ = line_->clock().virtual_now();
  line_->master().set_mode(first_mode(setup, *line_));
  summarize();
  open_ports(stepped);
  record_ = std::make_unique<LineRecord>(*line_, log_name(), format, print);
  record_->give_hints();
  line_->configure_faults(seed, note_);
  begin_programs(*line_, setup);
}

std::unique_ptr<Port> RunningLine::open(const PortSetup& port, bool stepped) {
  const SerialMode mode = line_->master().mode();
  switch (port.kind) {
    case PortSetup::Kind::Pty:
      return std::make_unique<PtyPort>(io_, port.path, mode.baud, port.access);
    case PortSetup::Kind::Tcp:
      return std::make_unique<TcpPort>(io_, port.address,
                                       stepped ? TcpPort::Linger() : TcpPort::kUsualLinger);
    case PortSetup::Kind::ModbusTcp:
      return std::make_unique<ModbusTcpServer>(io_, *line_, port.address, port.timeout, note_);
    case PortSetup::Kind::Serial:
      return std::make_unique<SerialPort>(io_, port.place, port.path, mode, port.echo);
  }
  return nullptr;
}

void RunningLine::open_ports(bool stepped) {
  for (const PortSetup& port : setup_.ports) {
    ports_.push_back(with_place(port.kind == PortSetup::Kind::Serial ? "" : port.place,
                                [&] { return open(port, stepped); }));
    if (port.wait) {
      ports_.back()->hold_line();
    }
    summary_.ports.push_back(ports_.back()->summary());
  }
}

void RunningLine::renew_memories() {
  for (std::size_t i = 0; i < line_->size(); ++i) {
    const EepromFile* file = memories_[i].get();
    const std::vector<std::uint8_t>& contents = line_->module(i).memory().contents();
    if (file != nullptr && file->found() && contents != *file->found() &&
        !file->write(0, {contents.data(), contents.size()})) {
      const std::string why = reason();
      throw std::runtime_error(place_of(setup_.modules[i].places, "eeprom") + file->path() +
                               ": cannot be written: " + why + "; name a path that can be written");
    }
  }
}

void RunningLine::make_missing_memories(std::list<NewFile>& made) {
  for (std::size_t i = 0; i < line_->size(); ++i) {
    EepromFile* file = memories_[i].get();
    if (file != nullptr && !file->found()) {
      with_place(place_of(setup_.modules[i].places, "eeprom"),
                 [&] { file->create(line_->module(i).memory().contents()); });
      made.emplace_back(file->path(), false);
    }
  }
}

/// The name of the line or, if it has none, the address of its first port; "line" if it has no port either.
std::string RunningLine::log_name() const {
  return !setup_.name.empty()      ? setup_.name
         : !summary_.ports.empty() ? summary_.ports.front().address
                                   : "line";
}

std::string RunningLine::remark(std::size_t index) const {
  const EepromFile* file = memories_[index].get();
  if (file == nullptr) {
    return "";
  }
  const ModuleSpec& spec = setup_.modules[index];
  if (!file->found()) {
    return file->path() + " is new";
  }
  const Module& module = line_->module(index).module();
  if (module.settings_unreadable()) {
    return file->path() +
           " contains no settings of this model; the module uses factory settings until it stores new ones";
  }
  const bool blank = module.state().statistics.settings_source == SettingsSource::Blank;
  const bool overruled = spec.settings_given && module.state().settings != spec.settings;
  return (blank ? file->path() + " is blank: factory settings" : "settings from " + file->path()) +
         (overruled ? ", not those given here" : "");
}

void RunningLine::summarize() {
  summary_.name = setup_.name;
  for (std::size_t i = 0; i < line_->size(); ++i) {
    SimulatedModule& module = line_->module(i);
    const State& state = module.module().state();
    const InForce& in_force = state.in_force;
    summary_.modules.push_back({std::string(module.model().designation), module.model().inputs,
                                module.model().outputs, in_force.address,
                                state.speaks_modbus() ? state.serial_number() : 0,
                                in_force.protocol == Protocol::Ascii, module.mode(), remark(i)});
  }
  summary_.mode = line_->master().mode();
  summary_.instant = setup_.instant;
}

void RunningLine::start() {
  for (std::size_t i = 0; i < line_->size(); ++i) {
    if (const EepromFile* file = memories_[i].get()) {
      line_->module(i).memory().keep(
          [file](std::uint16_t address, Bytes bytes) { return file->write(address, bytes); });
    }
  }
}

void RunningLine::start_paced(double speed, std::function<void()> begun) {
  connected_ = std::make_unique<LinePorts>(*line_, ports_, note_);
  pacer_ =
      std::make_unique<Pacer>(io_, *line_, *connected_, record_->frames(), pace_of(setup_, speed), note_);
  pacer_->start(std::move(begun));
}

SteppedLine& RunningLine::start_stepped(SteppedLine::Arrived arrived) {
  connected_ = std::make_unique<LinePorts>(*line_, ports_, note_);
  stepped_ = std::make_unique<SteppedLine>(*line_, *connected_, record_->frames());
  stepped_->start(std::move(arrived));
  return *stepped_;
}

void RunningLine::run_until(VirtualTime up) {
  const VirtualTime until = std::max(came_up_ + up, line_->clock().virtual_now());
  line_->wires().run_until(until);
  if (FrameWatch* frames = record_->frames()) {
    frames->run(until);
  }
}

}  // namespace ex9000::sim
