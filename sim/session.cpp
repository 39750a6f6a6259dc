#include "sim/session.hpp"

#include <stdexcept>
#include <utility>

#include "sim/ports/pty_port.hpp"
#include "sim/ports/serial_port.hpp"
#include "sim/ports/tcp_port.hpp"

namespace ex9000::sim {

namespace {

LineKind kind_of(const Arguments& arguments) {
  if (arguments.instant) {
    return kInstant;
  }
  return arguments.strict_gaps ? kStrictlyPaced : kPaced;
}

Pace pace_of(const Arguments& arguments) {
  if (arguments.instant) {
    return kInstantPace;
  }
  return arguments.strict_gaps ? kStrictWallPace : kWallPace;
}

}  // namespace

Session::Session(boost::asio::io_context& io, Arguments arguments, Print print)
    : io_(io), arguments_(std::move(arguments)), print_(std::move(print)) {
  for (const ModuleSpec& module : arguments_.modules) {
    memories_.push_back(module.eeprom.empty() ? nullptr : std::make_unique<EepromFile>(module.eeprom));
  }
  line_ = std::make_unique<Line>(arguments_.modules, kind_of(arguments_),
                                 [this](std::uint8_t byte, ByteStatus /*status*/) { pacer_->hear(byte); });
  use_memories();
  line_->come_up();
  line_->master().set_baud(arguments_.baud.value_or(line_->module(0).baud()));
  introduce();
  open_ports();
  open_control();
}

Session::~Session() = default;

void Session::use_memories() {
  for (std::size_t i = 0; i < line_->size(); ++i) {
    if (memories_[i] != nullptr && memories_[i]->found()) {
      line_->module(i).memory().contents() = *memories_[i]->found();
    }
  }
}

void Session::open_ports() {
  const std::uint32_t baud = line_->master().baud();
  if (arguments_.pty) {
    auto port = std::make_unique<PtyPort>(io_, *arguments_.pty, baud);
    introduced_.pty = port->pty().link();
    introduced_.pty_device = port->pty().device();
    ports_.push_back(std::move(port));
  }
  if (arguments_.tcp) {
    auto port = std::make_unique<TcpPort>(io_, *arguments_.tcp);
    introduced_.tcp = port->address();
    ports_.push_back(std::move(port));
  }
  if (arguments_.serial) {
    ports_.push_back(std::make_unique<SerialPort>(io_, *arguments_.serial, baud, arguments_.echo));
    introduced_.serial = *arguments_.serial;
  }
}

void Session::open_control() {
  if (!arguments_.control) {
    return;
  }
  control_.emplace(*line_);
  const auto carry_out = [this](const std::string& command) {
    Control::Reply reply;
    pacer_->now([&] { reply = control_->carry_out(command); });
    return reply;
  };
  control_socket_ =
      std::make_unique<ControlSocket>(io_, *arguments_.control, carry_out, [this] { io_.stop(); });
  introduced_.control = *arguments_.control;
}

/// What a module has stored while it came up follows it.
void Session::renew_memories() {
  for (std::size_t i = 0; i < line_->size(); ++i) {
    const EepromFile* file = memories_[i].get();
    const std::vector<std::uint8_t>& contents = line_->module(i).memory().contents();
    if (file != nullptr && file->found() && contents != *file->found() &&
        !file->write(0, {contents.data(), contents.size()})) {
      throw std::runtime_error("eeprom=" + file->path() + ": cannot be written");
    }
  }
}

/// All or none.
void Session::make_missing_memories() {
  std::vector<const EepromFile*> made;
  try {
    for (std::size_t i = 0; i < line_->size(); ++i) {
      EepromFile* file = memories_[i].get();
      if (file != nullptr && !file->found()) {
        file->create(line_->module(i).memory().contents());
        made.push_back(file);
      }
    }
  } catch (...) {
    for (const EepromFile* file : made) {
      file->discard();
    }
    throw;
  }
}

void Session::keep_memories() {
  for (std::size_t i = 0; i < line_->size(); ++i) {
    if (const EepromFile* file = memories_[i].get()) {
      line_->module(i).memory().keep(
          [file](std::uint16_t address, Bytes bytes) { return file->write(address, bytes); });
    }
  }
}

std::string Session::remark(std::size_t index) const {
  const EepromFile* file = memories_[index].get();
  if (file == nullptr) {
    return "";
  }
  const ModuleSpec& spec = arguments_.modules[index];
  if (!file->found()) {
    return file->path() + " is new";
  }
  const Module& module = line_->module(index).module();
  if (module.settings_unreadable()) {
    return file->path() + " holds no settings of this model: factory settings until some are stored";
  }
  const bool overruled = spec.settings_given && module.state().settings != spec.settings;
  return "settings from " + file->path() + (overruled ? ", not from the command line" : "");
}

void Session::introduce() {
  for (std::size_t i = 0; i < line_->size(); ++i) {
    SimulatedModule& module = line_->module(i);
    const InForce& in_force = module.module().state().in_force;
    introduced_.modules.push_back({std::string(module.model().designation), module.model().inputs,
                                   module.model().outputs, in_force.address,
                                   in_force.protocol == Protocol::Ascii, module.baud(), remark(i)});
  }
  introduced_.baud = line_->master().baud();
  introduced_.instant = arguments_.instant;
}

void Session::start() {
  renew_memories();
  make_missing_memories();
  keep_memories();
  std::vector<std::string> speakers{"master"};
  for (const ModuleIntroduced& module : introduced_.modules) {
    speakers.push_back(hex_byte_text(module.address) + " " + module.designation);
  }
  log_.emplace(speakers, print_);
  if (arguments_.log) {
    line_->bus().observe(*log_);
  }
  pacer_ = std::make_unique<Pacer>(
      io_, *line_, ports_, arguments_.log ? &*log_ : nullptr, pace_of(arguments_),
      [this](const std::string& text) { log_->note(line_->clock().virtual_now(), text); });
  print_(greeting(introduced_));
  pacer_->start();
  if (control_socket_) {
    control_socket_->start();
  }
}

}  // namespace ex9000::sim
