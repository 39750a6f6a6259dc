#include "sim/utility/real_line/real_line.hpp"

#include <algorithm>

#include "sim/line_monitor/frames/frame_meaning.hpp"
#include "sim/text/values.hpp"
#include "sim/utility/console/progress.hpp"
#include "sim/utility/device/channels.hpp"
#include "sim/utility/device/property.hpp"
#include "sim/utility/master_line/raw_exchange.hpp"

namespace ex9000::utility {

namespace {

using sim::Message;
using sim::RequestQueue;

}  // namespace

Environment RealLine::watched(Environment environment, WatchedConnection::See see) {
  environment.open = [open = environment.open, see = std::move(see)](const Port& port, hal::SerialMode mode) {
    return std::make_unique<WatchedConnection>(open(port, mode), mode, see);
  };
  return environment;
}

RealLine::RealLine(const Environment& environment, const Port& port, hal::SerialMode mode)
    : environment_(watched(environment, [this](const PortFrame& frame) { see(frame); })),
      line_(environment_, port, mode),
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
    modules_.push_back({std::move(device), each.identity.model, each.address, number});
    shown.models.push_back(each.identity.model);
  }
  Progress progress(environment_, "settings");
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    progress.show(i, modules_.size());
    speaker_ = i + 1;
    read_settings(modules_[i]);
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
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    answer_pages();
    speaker_ = i + 1;
    look_at(modules_[i]);
  }
}

void RealLine::answer_pages() {
  while (!asked_.empty()) {
    const RequestQueue::Request request = std::move(asked_.front());
    asked_.pop_front();
    if (!request.owner.expired()) {
      request.done(answer_to(request));
    }
  }
}

RequestQueue::Reply RealLine::answer_to(const RequestQueue::Request& request) {
  speaker_ = station_asked_by(request.bytes);
  RequestQueue::Reply reply;
  if (!request.expects_reply) {
    line_.connection().send(request.bytes);
    line_.connection().pause(RequestQueue::kTurnaround);
    return reply;
  }
  const Time on_the_line = time_of(request.bytes.size(), line_.mode());
  RawReply raw = raw_exchange(line_.connection(), request.bytes, request.timeout + on_the_line);
  reply.bytes = std::move(raw.bytes);
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
  if (!replies(module.device)) {
    module.replies = false;
    module.face["plate"] = silent_plate(module);
    return;
  }
  if (!std::exchange(module.replies, true)) {
    read_settings(module);
  }
  try {
    const bool timed_out = has_timed_out(module.device);
    Message plate = plate_of(module, timed_out);
    plate["outputs"] = module.model->has_outputs() ? outputs_of(module.device, *module.model) : 0;
    plate["inputs"] = module.model->has_inputs() ? inputs_of(module.device, *module.model) : 0;
    if (module.model->has_inputs()) {
      module.face["records"] = {{"high", latches_of(module.device, *module.model, true)},
                                {"low", latches_of(module.device, *module.model, false)},
                                {"counters", counters_of(module.device, *module.model)}};
    }
    read_setting(module, module.next_setting);
    module.next_setting = (module.next_setting + 1) % properties.size();
    module.face["plate"] = std::move(plate);
    module.face["stored"] = {{"settings", module.settings}};
    module.face["hostWatchdog"] = {{"enabled", module.settings["watchdog"] == "on"},
                                   {"timedOut", timed_out},
                                   {"timeout", module.settings["watchdog-timeout"]}};
  } catch (const Failed&) {  // NOLINT(bugprone-empty-catch)
    // a reply has been lost: the next look reads all again
  }
}

Message RealLine::plate_of(Module& module, bool timed_out) {
  const hal::SerialMode mode = line_.mode();
  return {
      {"powered", true},
      {"listening", true},
      {"initMode", module.device.in_init()},
      {"address", module.address},
      {"serialNumber", module.serial_number ? Message(sim::hex_long_text(*module.serial_number)) : Message()},
      {"baud", mode.baud},
      {"format", sim::line_format_text(mode.format)},
      {"protocol", module.device.speaks_modbus() ? "modbus" : "ascii"},
      {"checksum", module.device.checksum()},
      {"led", timed_out ? "flashing" : "on"},
      {"timers", std::vector<unsigned>(module.model->outputs)}};
}

/// Of one that does not reply.
Message RealLine::silent_plate(const Module& module) {
  return {{"powered", false}, {"listening", false}, {"address", module.address}, {"led", "no reply"}};
}

void RealLine::read_settings(Module& module) {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    read_setting(module, i);
  }
}

void RealLine::read_setting(Module& module, std::size_t position) {
  const Property& property = properties[position];
  try {
    if (meets(*module.model, property.needs)) {
      module.settings[std::string(property.key)] = property.read(module.device, *module.model);
    }
  } catch (const Failed&) {  // NOLINT(bugprone-empty-catch)
    // the module does not have it, or a reply has been lost
  }
}

}  // namespace ex9000::utility
