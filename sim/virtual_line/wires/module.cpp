#include "sim/virtual_line/wires/module.hpp"

#include <algorithm>

#include "firmware/expect.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

/// Slow: the wake timer serves all deadlines, and the tick only feeds the hardware watchdog.
constexpr Duration kTick = milliseconds(400);

}  // namespace

SimulatedModule::Mcu::Mcu(SimulatedModule& module)
    : line(module.clock_, module.wire_, module.timing_at_),
      silence_timer(module.clock_),
      wake_timer(module.clock_),
      tick(module.clock_, kTick),
      watchdog(module.clock_),
      device(module.model_, {module.clock_, line, silence_timer, wake_timer, module.inputs_, module.outputs_,
                             hal::TwoPlaces<hal::doubles::Memory&>(module.memory_), module.init_switch_,
                             module.led_, watchdog, module.kept_word_, module.slots_}) {}

SimulatedModule::SimulatedModule(Wires& wires, const Model& model, TimingAt timing_at)
    : clock_(wires.clock()),
      model_(model),
      timing_at_(timing_at),
      end_(wires.attach(*this)),
      memory_(clock_),
      slots_(clock_, model),
      wire_(clock_, end_) {}

void SimulatedModule::power(bool on) {
  switched_on_ = on;
  follow_supply();
}

void SimulatedModule::interrupt_supply(bool interrupted) {
  supply_interrupted_ = interrupted;
  follow_supply();
}

void SimulatedModule::follow_supply() {
  const bool on = switched_on_ && !supply_interrupted_;
  if (on == powered()) {
    return;
  }
  say(on ? "power on" : "power off");
  if (on) {
    start(ResetReason::PowerOn);
  } else {
    stop();
    led_.light(false);
  }
  settle();
}

void SimulatedModule::tell(Event event) {
  event_ = std::move(event);
  outputs_.on_change(
      [this](std::uint16_t channels) { say("outputs " + hex_word_text(channels) + why_outputs_change()); });
}

void SimulatedModule::say(const std::string& text) const {
  if (event_) {
    event_(text);
  }
}

/// Empty if the cause is a request or an output timer.
std::string SimulatedModule::why_outputs_change() const {
  if (!powered()) {
    return switched_on_ && !supply_interrupted_ ? ": reset" : ": no power";
  }
  return !module().listening()                      ? ": start"
         : module().state().settings.timeout_status ? ": host watchdog"
                                                    : "";
}

void SimulatedModule::restart(ResetReason reason) {
  if (powered()) {
    say(reason == ResetReason::ModuleWatchdog ? "reset by the module watchdog"
        : reason == ResetReason::Software     ? "reset into a new image"
                                              : "reset");
    stop();
    start(reason);
    settle();
  }
}

void SimulatedModule::start(ResetReason reason) {
  hangs_until_ = VirtualTime(0);
  in_dcon_frame_ = false;
  stores_ = 0;
  const std::uint16_t earlier = slots_.version();
  [[maybe_unused]] const bool boots = slots_.boot();
  EX9000_EXPECT(boots);
  if (slots_.version() != earlier) {
    say("version " + hex_word_text(slots_.version()));
  }
  mcu_.emplace(*this);
  mcu_->device.module().pretend_version(slots_.version());
  mcu_->line.release_late(driver_late_by_);
  mcu_->tick.start();
  mcu_->device.start(reason, serial_number_);
  if (images_are_bad_ && slots_.unconfirmed()) {
    hangs_until_ = kNever;
  }
  turn();
}

void SimulatedModule::stop() {
  end_.hear_alone();
  mcu_->line.abort();
  wire_.abort();
  // First, because a memory job uses buffers in `mcu_`.
  memory_.cut();
  slots_.cut();
  mcu_.reset();
  outputs_.drive(0);
}

void SimulatedModule::set_init(bool asserted) {
  init_switch_.set(asserted);
  say(asserted ? "INIT* tied to GND" : "INIT* released");
  react();
}

void SimulatedModule::set_input(unsigned channel, bool level) {
  if (inputs_.set(channel, level)) {
    say("input " + std::to_string(channel) + (level ? " on" : " off"));
    edge(channel, level);
    react();
  }
}

void SimulatedModule::pulse_input(unsigned channel, std::uint32_t count) {
  say("input " + std::to_string(channel) + " pulse x" + std::to_string(count));
  const bool level = inputs_.level(channel);
  for (std::uint32_t i = 0; i < count; ++i) {
    edge(channel, !level);
    edge(channel, level);
    if (i % 1024 == 0) {
      react();
    }
  }
  react();
}

/// Makes the device process INIT* and edges now; a real board does at the next interrupt or tick.
void SimulatedModule::react() {
  if (powered()) {
    work();
  }
}

void SimulatedModule::edge(unsigned channel, bool level) {
  if (powered() && channel < model_.inputs) {
    mcu_->device.on_edge(channel, level);
  }
}

void SimulatedModule::release_driver_late(VirtualTime by) {
  driver_late_by_ = by;
  if (powered()) {
    mcu_->line.release_late(by);
    settle();
  }
}

void SimulatedModule::force_rate(std::uint32_t baud) {
  wire_.force_rate(baud);
  settle();
}

void SimulatedModule::end_reply_delays(std::size_t fault) {
  wire_.end_delays(fault);
  settle();
}

void SimulatedModule::hang(VirtualTime time) {
  hangs_until_ = time == kNever ? kNever : clock_.virtual_now() + time;
  settle();
}

void SimulatedModule::stop_tick() {
  mcu_->tick.stop();
  settle();
}

std::vector<std::uint8_t> SimulatedModule::memory_image(const Model& model, const Settings& settings) {
  std::vector<std::uint8_t> image(hal::doubles::Memory::kSize, 0xFF);
  if (settings != Settings::factory(model)) {
    RecordBytes record{};
    write_record(model, settings, 1, record);
    std::copy_n(record.begin(), record_size({record.data(), record.size()}), image.begin() + hal::kPlaces[0]);
  }
  return image;
}

bool SimulatedModule::pending() const {
  return wire_.next() != kNever || memory_.next() != kNever || slots_.next() != kNever ||
         (mcu_ &&
          (mcu_->silence_timer.next() != kNever || mcu_->line.sending() || !mcu_->device.module().at_rest()));
}

/// Tells the wires the receiver's mode and the time of the next `run`.
void SimulatedModule::settle() {
  if (mode() != listens_in_) {
    listens_in_ = mode();
    end_.listen(listens_in_);
  }
  if (mcu_) {
    const VirtualTime sends = std::min(wire_.next(), mcu_->line.next());
    const VirtualTime stores = std::min(memory_.next(), slots_.next());
    VirtualTime wakes = std::min(mcu_->wake_timer.next(), mcu_->tick.next());
    if (hangs_until_ != VirtualTime(0)) {
      wakes = std::min(wakes, hangs_until_);
    }
    next_without_silence_ = std::min(std::min(sends, stores), std::min(wakes, mcu_->watchdog.next()));
    wait();
  } else {
    run_at(kNever);
  }
}

void SimulatedModule::run() {
  runs_at_ = kNever;
  if (next_without_silence_ > clock_.virtual_now()) {
    end_silence();  // only the silence timer can be due
    work_or_wait();
    return;
  }
  if (mcu_->watchdog.restarts()) {
    restart(ResetReason::Software);
    return;
  }
  if (mcu_->watchdog.has_expired()) {
    ++watchdog_resets_;
    restart(ResetReason::ModuleWatchdog);
    return;
  }
  run_line();
  run_memory();
  end_silence();
  run_timers();
  const bool resumes = hangs_until_ != VirtualTime(0) && hangs_until_ <= clock_.virtual_now();
  if (resumes) {
    hangs_until_ = VirtualTime(0);
  }
  if (resumes || mcu_->device.has_work()) {
    turn();
    say_stores();
  }
  settle();
}

void SimulatedModule::say_stores() {
  if (const std::uint16_t stores = module().state().statistics.stores; stores != stores_) {
    stores_ = stores;
    say("settings stored");
  }
}

void SimulatedModule::end_silence() {
  if (mcu_->silence_timer.fire()) {
    mcu_->device.on_silence();
    if (module().arbitrates()) {
      mcu_->silence_timer.restart_at(mcu_->silence_timer.next() + skew_);
    }
    if (mcu_->line.sending()) {
      settle();  // an arbitration has begun to send
    }
  }
}

void SimulatedModule::run_line() {
  wire_.run();
  const bool was_sending = mcu_->line.sending();
  mcu_->line.run();
  if (was_sending && !mcu_->line.sending()) {
    mcu_->device.on_sent();
    in_dcon_frame_ = false;
  }
}

void SimulatedModule::run_memory() {
  if (std::min(memory_.next(), slots_.next()) <= clock_.virtual_now()) {
    memory_.run();
    slots_.run();
    mcu_->device.on_memory();
  }
}

void SimulatedModule::run_timers() {
  if (mcu_->wake_timer.fire()) {
    mcu_->device.on_wake_timer();
  }
  if (mcu_->tick.fire()) {
    mcu_->device.on_tick();
  }
}

void SimulatedModule::receive(std::uint8_t byte, ByteStatus status) {
  if (mcu_->line.sending() || wire_.sends_late()) {
    return;
  }
  if (mcu_->silence_timer.next() <= clock_.virtual_now()) {
    receive_after_silence(byte, status);
    return;
  }
  in_dcon_frame_ = byte != DconAssembler::kEnd || status != ByteStatus::Good;
  mcu_->device.on_receive(byte, status);
  work_or_wait();  // most bytes cause no work
}

std::optional<Hearing> SimulatedModule::hearing() const {
  if (!mcu_ || pending()) {
    return std::nullopt;
  }
  const InForce& in_force = module().state().in_force;
  if (in_force.protocol == Protocol::Ascii && in_dcon_frame_) {
    return std::nullopt;
  }
  return Hearing{in_force.protocol, in_force.checksum, in_force.baud_code, in_force.address,
                 timing_at_(baud_rate(in_force.baud_code), line_format(in_force.baud_code))};
}

void SimulatedModule::catch_up(const Heard& missed) {
  for (std::size_t verdict = 0; verdict < missed.verdicts.size(); ++verdict) {
    if (missed.verdicts[verdict] != 0) {
      mcu_->device.module().tallies().count_in_interrupt(static_cast<Verdict>(verdict),
                                                         missed.verdicts[verdict]);
    }
  }
  for (const std::uint16_t each : missed.frame) {
    if (each == Heard::kSilence) {
      mcu_->device.on_silence();
    } else {
      mcu_->device.on_receive(static_cast<std::uint8_t>(each), ByteStatus::Good);
    }
  }
  mcu_->silence_timer.restart_at(missed.silence_ends);
  in_dcon_frame_ = !missed.frame.empty();
  wait();
}

/// The silence timer's interrupt comes before the receive interrupt, see hal/one_shot_timer.hpp.
void SimulatedModule::receive_after_silence(std::uint8_t byte, ByteStatus status) {
  end_silence();
  receive(byte, status);
}

void SimulatedModule::work() {
  turn();
  settle();
}

/// Runs the main loop until it has no work, in no virtual time; not while it hangs.
void SimulatedModule::turn() {
  if (hangs_until_ != VirtualTime(0)) {
    return;
  }
  while (mcu_->device.turn() || mcu_->device.has_work()) {
  }
}

}  // namespace ex9000::sim
