#include "sim/app/running_line/running_line.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sim/app/setup/line_factory.hpp"
#include "sim/files_and_ports/ports/pty_port.hpp"
#include "sim/files_and_ports/ports/serial_port.hpp"
#include "sim/files_and_ports/ports/tcp_port.hpp"
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
    with_place(module.eeprom_place, [&] {
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
  introduce();
  open_ports(stepped);
  record_ = std::make_unique<LineRecord>(*line_, log_name(), format, print);
  record_->give_hints();
  line_->configure_faults(seed, note_);
  with_place(place_of(setup.places, "fault"), [&] { begin_programs(*line_, setup); });
}

void RunningLine::open_ports(bool stepped) {
  const SerialMode mode = line_->master().mode();
  if (setup_.pty) {
    auto port = with_place(place_of(setup_.places, "pty"), [&] {
      return std::make_unique<PtyPort>(io_, *setup_.pty, mode.baud, setup_.pty_access);
    });
    introduced_.pty = port->pty().link();
    introduced_.pty_device = port->pty().device();
    ports_.push_back(std::move(port));
  }
  if (setup_.tcp) {
    const TcpPort::Linger linger = stepped ? TcpPort::Linger() : TcpPort::kUsualLinger;
    auto port = with_place(place_of(setup_.places, "tcp"),
                           [&] { return std::make_unique<TcpPort>(io_, *setup_.tcp, linger); });
    introduced_.tcp = port->address();
    ports_.push_back(std::move(port));
  }
  if (setup_.modbus_tcp) {
    modbus_tcp_ = with_place(place_of(setup_.places, "modbus-tcp"), [&] {
      return std::make_unique<ModbusTcpServer>(io_, *line_, *setup_.modbus_tcp,
                                               setup_.modbus_timeout.value_or(kGatewayTimeout), note_);
    });
    introduced_.modbus_tcp = modbus_tcp_->address();
  }
  if (setup_.serial) {
    ports_.push_back(std::make_unique<SerialPort>(io_, place_of(setup_.places, "serial"), *setup_.serial,
                                                  mode, setup_.echo));
    introduced_.serial = *setup_.serial;
  }
}

void RunningLine::renew_memories() {
  for (std::size_t i = 0; i < line_->size(); ++i) {
    const EepromFile* file = memories_[i].get();
    const std::vector<std::uint8_t>& contents = line_->module(i).memory().contents();
    if (file != nullptr && file->found() && contents != *file->found() &&
        !file->write(0, {contents.data(), contents.size()})) {
      const std::string why = reason();
      throw std::runtime_error(setup_.modules[i].eeprom_place + file->path() + ": cannot be written: " + why +
                               "; name a path that can be written");
    }
  }
}

void RunningLine::make_missing_memories(std::list<NewFile>& made) {
  for (std::size_t i = 0; i < line_->size(); ++i) {
    EepromFile* file = memories_[i].get();
    if (file != nullptr && !file->found()) {
      with_place(setup_.modules[i].eeprom_place, [&] { file->create(line_->module(i).memory().contents()); });
      made.emplace_back(file->path(), false);
    }
  }
}

/// Returns the name of the line. If the line has no name, returns the path or the address of its first port,
/// in the order pseudo-terminal, TCP, Modbus TCP, serial. If the line has no port either, returns "line".
std::string RunningLine::log_name() const {
  for (const std::string& name :
       {setup_.name, introduced_.pty, introduced_.tcp, introduced_.modbus_tcp, introduced_.serial}) {
    if (!name.empty()) {
      return name;
    }
  }
  return "line";
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
  const bool of_a_bus_file = !setup_.places.empty();
  const std::string others = of_a_bus_file ? ", not from the bus file" : ", not from the command line";
  return (blank ? file->path() + " is blank: factory settings" : "settings from " + file->path()) +
         (overruled ? others : "");
}

void RunningLine::introduce() {
  introduced_.name = setup_.name;
  for (std::size_t i = 0; i < line_->size(); ++i) {
    SimulatedModule& module = line_->module(i);
    const InForce& in_force = module.module().state().in_force;
    introduced_.modules.push_back({std::string(module.model().designation), module.model().inputs,
                                   module.model().outputs, in_force.address,
                                   in_force.protocol == Protocol::Ascii, module.mode(), remark(i)});
  }
  introduced_.mode = line_->master().mode();
  introduced_.instant = setup_.instant;
}

void RunningLine::start() {
  for (std::size_t i = 0; i < line_->size(); ++i) {
    if (const EepromFile* file = memories_[i].get()) {
      line_->module(i).memory().keep(
          [file](std::uint16_t address, Bytes bytes) { return file->write(address, bytes); });
    }
  }
}

void RunningLine::start_paced(double speed) {
  connected_ = std::make_unique<LinePorts>(*line_, ports_, modbus_tcp_.get(), note_);
  pacer_ =
      std::make_unique<Pacer>(io_, *line_, *connected_, record_->frames(), pace_of(setup_, speed), note_);
  pacer_->start();
}

SteppedLine& RunningLine::start_stepped(SteppedLine::Arrived arrived) {
  connected_ = std::make_unique<LinePorts>(*line_, ports_, modbus_tcp_.get(), note_);
  stepped_ = std::make_unique<SteppedLine>(*line_, *connected_, record_->frames());
  stepped_->start(std::move(arrived));
  return *stepped_;
}

void RunningLine::run_until(VirtualTime up) {
  const VirtualTime until = std::max(came_up_ + up, line_->clock().virtual_now());
  line_->bus().run_until(until);
  if (FrameWatch* frames = record_->frames()) {
    frames->run(until);
  }
}

}  // namespace ex9000::sim
