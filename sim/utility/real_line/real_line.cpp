#include "sim/utility/real_line/real_line.hpp"

#include <algorithm>

#include "sim/line_monitor/frames/frame_meaning.hpp"
#include "sim/text/values.hpp"
#include "sim/utility/console/progress.hpp"
#include "sim/utility/device/channels.hpp"
#include "sim/utility/device/property.hpp"
#include "sim/utility/master_line/raw_exchange.hpp"
#include "sim/utility/modbus/register_map.hpp"

namespace ex9000::utility {

namespace {

using sim::Message;
using sim::RequestQueue;

constexpr std::size_t kLongestFrame = 256;

/// Modbus: other functions than those that only read. DCON: `%`, `~AA...`, `$AAP...`.
bool may_change_settings(const Data& request) {
  constexpr std::size_t kCommandAt = 3;
  if (sim::looks_like_dcon(request)) {
    return request[0] == '%' || request[0] == '~' ||
           (request[0] == '$' && request.size() > kCommandAt && request[kCommandAt] == 'P');
  }
  constexpr std::uint8_t kLastRead = 0x04;
  constexpr std::uint8_t kReadName = 0x11;
  return request[1] > kLastRead && request[1] != kReadName;
}

}  // namespace

Environment RealLine::watched(Environment environment, WatchedConnection::See see) {
  environment.open = [open = environment.open, see = std::move(see)](const Port& port, hal::SerialMode mode) {
    return std::make_unique<WatchedConnection>(open(port, mode), mode, see);
  };
  return environment;
}

RealLine::RealLine(const Environment& environment, const Port& port, hal::SerialMode mode, Time patience)
    : environment_(watched(environment, [this](const PortFrame& frame) { see(frame); })),
      line_(environment_, port, mode),
      patience_(patience),
      began_(line_.connection().now()) {}

void RealLine::show_on(sim::Panel& panel, const std::vector<FoundModule>& found) {
  sim::PanelLine shown;
  shown.summary.ports.push_back({"serial", line_.name(), ""});
  for (const FoundModule& each : found) {
    line_.dcon().set_checksum(each.checksum);
    const auto number = each.identity.serial_number;
    Device device =
        each.speaks == Speaks::Ascii
            ? Device::in_ascii(line_, each.address)
            : Device::in_modbus(line_, number ? with_serial_number(*number) : at_address(each.address));
    device.set_in_init(each.stored_address.has_value());
    device.set_patience(patience_);
    modules_.push_back({std::move(device), each.identity.model, each.address, number});
    shown.models.push_back(each.identity.model);
  }
  Progress progress(environment_, "settings");
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    progress.show(i, modules_.size());
    speaker_ = i + 1;
    look_at(modules_[i]);
  }
  progress.show(1, 1);
  shown.present = [this] { return line_.connection().now() - began_; };
  shown.face = [this](std::size_t module) { return modules_[module].face; };
  shown.faults = [] { return std::vector<sim::Faults::Info>(); };
  panel.add_line(std::move(shown));
  panel_ = &panel;
}

void RealLine::see(const PortFrame& seen) {
  replies_ = seen.sent ? speaker_ : replies_;
  if (panel_ == nullptr) {
    return;
  }
  sim::Frame frame;
  frame.station = seen.sent ? 0 : replies_;
  frame.bytes = seen.bytes;
  frame.sent_in = frame.line_in = seen.mode;
  frame.began = seen.began - began_;
  frame.ended = seen.ended - began_;
  panel_->hear(0, frame);
}

void RealLine::look() {
  for (std::size_t i = 1; i <= modules_.size(); ++i) {
    const std::size_t next = (turn_ + i) % modules_.size();
    if (!modules_[next].replies) {
      turn_ = next;
      break;
    }
  }
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    answer_page();
    if (modules_[i].replies || i == turn_) {
      speaker_ = i + 1;
      look_at(modules_[i]);
    }
  }
}

/// One request: pages must not keep the modules from being polled.
void RealLine::answer_page() {
  if (asked_.empty()) {
    return;
  }
  const RequestQueue::Request request = std::move(asked_.front());
  asked_.pop_front();
  if (!request.owner.expired()) {
    speaker_ = station_asked_by(request.bytes);
    const RequestQueue::Reply reply = answer_to(request);
    note_effect(request.bytes, reply.bytes);
    request.done(reply);
  }
}

/// It may have changed settings, or the address of a module in ASCII (`%AANNTTCCFF`), but not in INIT mode.
void RealLine::note_effect(const Data& request, const Data& reply) {
  if (speaker_ > modules_.size()) {
    return;
  }
  Module& module = modules_[speaker_ - 1];
  module.known = module.known && !may_change_settings(request);
  constexpr std::size_t kNewAddressAt = 3;
  const std::string command(request.begin(), request.end());
  const std::string digits = command.size() > kNewAddressAt ? command.substr(kNewAddressAt, 2) : "";
  const bool is_address =
      digits.size() == 2 && digits.find_first_not_of("0123456789ABCDEF") == std::string::npos;
  if (command[0] == '%' && is_address && !module.device.in_init() &&
      std::string(reply.begin(), reply.end()).rfind("!" + digits, 0) == 0) {
    module.address = sim::parse_hex_byte(digits);
    module.device.moves_to(module.address);
  }
}

RequestQueue::Reply RealLine::answer_to(const RequestQueue::Request& request) {
  RequestQueue::Reply reply;
  if (!request.expects_reply) {
    raw_send(line_.connection(), request.bytes);
    line_.connection().pause(RequestQueue::kTurnaround);
    return reply;
  }
  const Time on_the_line = time_of(request.bytes.size(), line_.mode());
  RawReply raw =
      raw_exchange(line_.connection(), request.bytes, request.timeout + on_the_line, line_.modbus().echoes());
  reply.bytes = std::move(raw.bytes);
  reply.damaged = reply.bytes.size() > kLongestFrame ||
                  (sim::looks_like_dcon(request.bytes) && !reply.bytes.empty() && reply.bytes.back() != '\r');
  reply.delay = std::max(Time(0), raw.delay - on_the_line);
  return reply;
}

/// Beyond all modules: none of them.
std::size_t RealLine::station_asked_by(const Data& request) const {
  const bool dcon = sim::looks_like_dcon(request);
  const std::string text(request.begin(), request.end());
  const auto asked = std::find_if(modules_.begin(), modules_.end(), [&](const Module& module) {
    return module.device.speaks_modbus() ? !dcon && request[0] == module.address
                                         : dcon && text.substr(1, 2) == sim::hex_byte_text(module.address);
  });
  return static_cast<std::size_t>(asked - modules_.begin()) + 1;
}

void RealLine::look_at(Module& module) {
  if (module.device.replies()) {
    try {
      read_state(module);
      module.replies = true;
      return;
    } catch (const Failed&) {  // NOLINT(bugprone-empty-catch)
      // it has stopped to reply
    }
  }
  module.replies = false;
  module.known = false;
  Message plate = nameplate_of(module);
  plate.update({{"powered", false}, {"listening", false}, {"led", "no reply"}});
  module.face["plate"] = std::move(plate);
}

void RealLine::read_state(Module& module) {
  const Model& model = *module.model;
  if (!module.known) {
    read_settings(module);
  }
  read_setting(module, module.next_setting);
  module.next_setting = (module.next_setting + 1) % properties.size();
  const bool timed_out = has_timed_out(module.device);
  Message plate = nameplate_of(module);
  plate.update({{"powered", true},
                {"listening", true},
                {"led", timed_out ? "flashing" : "on"},
                {"outputs", model.has_outputs() ? outputs_of(module.device, model) : 0},
                {"inputs", model.has_inputs() ? inputs_of(module.device, model) : 0}});
  if (model.has_inputs()) {
    module.face["records"] = {{"high", latches_of(module.device, model, true)},
                              {"low", latches_of(module.device, model, false)},
                              {"counters", counters_of(module.device, model)}};
  }
  module.face["plate"] = std::move(plate);
  module.face["stored"] = {{"settings", module.settings}};
  module.face["hostWatchdog"] = {{"enabled", module.settings["watchdog"] == "on"},
                                 {"timedOut", timed_out},
                                 {"timeout", module.settings["watchdog-timeout"]}};
}

/// What does not depend on whether it replies.
Message RealLine::nameplate_of(const Module& module) const {
  Message plate{{"initMode", module.device.in_init()},
                {"address", module.address},
                {"protocol", module.device.speaks_modbus() ? "modbus" : "ascii"},
                {"checksum", module.device.checksum()}};
  if (module.serial_number) {
    plate["serialNumber"] = sim::hex_long_text(*module.serial_number);
  }
  if (line_.has_modes()) {
    plate.update({{"baud", line_.mode().baud}, {"format", sim::line_format_text(line_.mode().format)}});
  }
  return plate;
}

void RealLine::read_settings(Module& module) {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    read_setting(module, i);
  }
  module.known = true;
}

/// Before the first one, the address in force.
void RealLine::read_setting(Module& module, std::size_t position) {
  constexpr unsigned kOwnAddress = registers_of("own-address");
  const Property& property = properties[position];
  try {
    if (position == 0 && module.device.speaks_modbus() && module.serial_number) {
      module.address = static_cast<std::uint8_t>(module.device.extension(kOwnAddress));
    }
    if (meets(*module.model, property.needs)) {
      module.settings[std::string(property.key)] = property.read(module.device, *module.model);
    }
  } catch (const Absent&) {  // NOLINT(bugprone-empty-catch)
    // the module does not have it
  } catch (const Failed&) {
    if (!module.device.replies()) {
      throw;
    }
  }
}

}  // namespace ex9000::utility
