#include "tests/world/plant.hpp"

#include <algorithm>

#include "sim/notation/module_notation.hpp"
#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/world/limits.hpp"

namespace ex9000::world {

namespace {

sim::ModuleSpec spec_of(const Member& member) {
  sim::ModuleSpec spec = sim::factory_fresh(sim::model_called(member.row->designation));
  spec.serial_number = member.serial_number;
  if (member.blank) {
    return spec;
  }
  const reference::Stored& stored = member.stored;
  Settings& settings = spec.settings;
  settings.address = static_cast<std::uint8_t>(stored.address);
  settings.baud_code = static_cast<std::uint8_t>(stored.baud_code);
  settings.format = static_cast<std::uint8_t>(stored.format);
  settings.protocol = stored.modbus ? Protocol::ModbusRtu : Protocol::Ascii;
  settings.watchdog_timeout = static_cast<std::uint8_t>(stored.timeout);
  settings.watchdog_enabled = stored.enabled;
  settings.timeout_status = stored.timed_out;
  settings.name = Name(stored.name);
  settings.power_on_value = static_cast<std::uint16_t>(stored.power_on);
  settings.safe_value = static_cast<std::uint16_t>(stored.safe);
  for (unsigned channel = 0; channel < member.row->inputs; ++channel) {
    settings.input_filters.set(channel, static_cast<std::uint16_t>(stored.filters[channel]));
  }
  settings.inverted_inputs = static_cast<std::uint16_t>(stored.inversion);
  settings.fed_by_requests = stored.restarted_by_requests != 0;
  settings.serial_number = stored.serial_number;
  settings.updates_allowed = stored.updates_allowed != 0;
  settings.response_delay = static_cast<std::uint8_t>(stored.delay);
  return spec;
}

}  // namespace

/// Hears what the module hears, and tells the judge. A byte comes before what the module does at the same
/// time, although the module may hear it first.
struct Plant::Subject final : sim::Station, sim::WireObserver {
  Subject(sim::Line& its_line, std::size_t its_index, const Setup& setup, Plant& its_plant)
      : plant(its_plant),
        module(its_line.module(its_index)),
        clock(its_line.clock()),
        end(its_line.wires().attach(*this)),
        station(its_index + 1),
        judge(*setup.members[its_index].row, [this](const std::string& text) { object(text); }) {
    const Member& member = setup.members[its_index];
    judge.set_serial_number_of_board(member.serial_number);
    if (!member.blank) {
      judge.store(member.stored);
    }
    its_line.wires().observe(*this);
    module.tell([this](const std::string& text) {
      const unsigned reason = text == "reset by the module watchdog" ? kResetByWatchdog
                              : text == "reset into a new image"     ? kResetByUpdate
                                                                     : 0;
      if (reason != 0) {
        const Time now = clock.virtual_now();
        sends = false;
        later([=] { judge.reset(reason, now); });
      }
    });
    module.output_pins().on_change([this](std::uint16_t channels) {
      const Time now = clock.virtual_now();
      later([=] { judge.drive(channels, now); });
    });
    module.led().on_change([this](bool on) {
      const Time now = clock.virtual_now();
      later([=] { judge.light(on, now); });
    });
    module.watch_replies(
        [this](sim::Reply& reply) {
          const Time now = clock.virtual_now();
          sends = true;
          ++plant.replies_;
          later([=, bytes = reply.bytes] { judge.reply(bytes, now); });
          reply.lost = spoils && late_by == Time(0);
          reply.late_by = spoils ? late_by : Time(0);
          spoils = false;
        },
        [this] {
          const Time now = clock.virtual_now();
          sends = false;
          later([=] { judge.replied(now); });
        });
  }

  void object(const std::string& text) {
    if (plant.objection_.empty()) {
      plant.objection_ = "module " + std::to_string(station) + ", " + text;
    }
  }
  void later(std::function<void()> what) {
    happened.push_back({clock.virtual_now(), false, std::move(what)});
  }

  /// Follows the module's mode, and passes on what has happened.
  void look() {
    std::stable_sort(happened.begin(), happened.end(), [](const Happened& a, const Happened& b) {
      return std::make_pair(a.when, !a.byte) < std::make_pair(b.when, !b.byte);
    });
    for (const Happened& each : happened) {
      if (plant.objection_.empty()) {
        each.tell();
      }
    }
    happened.clear();
    if (const hal::SerialMode now = module.mode(); now != mode) {
      mode = now;
      end.listen(mode);
      if (mode.baud != 0) {
        judge.listen(mode.baud, mode.format, clock.virtual_now());
      }
    }
  }

  // --- sim::Station ---
  void run() override {}
  void receive(std::uint8_t byte, ByteStatus status) override {
    if (sends || drives) {
      return;
    }
    const Time now = clock.virtual_now();
    happened.push_back({now, true, [=] { judge.hear(byte, status == ByteStatus::Good, now); }});
  }

  // --- sim::WireObserver ---
  void driver(std::size_t whose, bool on, sim::VirtualTime /*now*/) override {
    drives = whose == station ? on : drives;
  }
  void byte(std::size_t /*station*/, std::uint8_t /*byte*/, hal::SerialMode /*mode*/, bool /*collided*/,
            sim::VirtualTime /*start*/, sim::VirtualTime /*end*/) override {}

  struct Happened {
    Time when;
    bool byte;
    std::function<void()> tell;
  };

  Plant& plant;
  sim::SimulatedModule& module;
  sim::VirtualClock& clock;
  sim::WireEnd& end;
  std::size_t station;
  Judge judge;
  hal::SerialMode mode{};
  std::vector<Happened> happened;
  bool sends = false;
  bool drives = false;
  bool spoils = false;
  reference::UpdateState update{};  ///< the last one seen
  Time late_by{0};
};

Plant::Plant(const Setup& setup) {
  std::vector<sim::ModuleSpec> specs;
  for (const Member& member : setup.members) {
    specs.push_back(spec_of(member));
  }
  line_ = std::make_unique<sim::Line>(specs, sim::kPaced, [](std::uint8_t, ByteStatus) {});
  line_->clock().set(setup.begins);
  for (std::size_t i = 0; i < setup.members.size(); ++i) {
    subjects_.push_back(std::make_unique<Subject>(*line_, i, setup, *this));
  }
  noise_ = std::make_unique<sim::Noise>(line_->wires(), sim::NoiseRates{}, 1);
  for (std::size_t i = 1; i < setup.masters; ++i) {
    others_.push_back(std::make_unique<sim::Master>(line_->wires(), hal::SerialMode{9600},
                                                    [](std::uint8_t, ByteStatus) {}));
  }
}

Plant::~Plant() = default;

const Possible& Plant::likely(std::size_t module) const { return subjects_[module]->judge.likely(); }

void Plant::look() {
  for (const auto& subject : subjects_) {
    subject->look();
    widest_ = std::max(widest_, subject->judge.size());
    gave_up_ = gave_up_ || subject->judge.gave_up();
  }
}

void Plant::run_until(Time until) {
  while (objection_.empty() && !gave_up_ && line_->wires().next() <= until) {
    line_->wires().run_next(until);
    look();
  }
  if (gave_up_) {
    return;
  }
  line_->clock().set(std::max(until, now()));
  for (const auto& subject : subjects_) {
    if (objection_.empty()) {
      subject->judge.pass(now());
    }
    const reference::UpdateState state = subject->judge.likely().module().update().state;
    if (state != subject->update) {
      subject->update = state;
      ++updates_[static_cast<std::size_t>(state)];
    }
  }
}

void Plant::play(const Step& step) {
  run_until(now());
  const Time at = now();
  const auto module = [this](std::size_t index) -> sim::SimulatedModule& { return line_->module(index); };
  const auto judge = [this](std::size_t index) -> Judge& { return subjects_[index]->judge; };
  struct Play {
    Plant& plant;
    Time at;
    decltype(module)& of;
    decltype(judge)& judged;

    void operator()(const Send& send) const {
      sim::Master& master = send.master == 0 ? plant.line_->master() : *plant.others_[send.master - 1];
      master.set_mode(send.mode);
      master.send(send.bytes.data(), send.bytes.size());
      ++plant.requests_;
    }
    void operator()(const Wait& wait) const { plant.run_until(at + wait.time); }
    void operator()(const Power& power) const {
      if (of(power.module).powered() != power.on) {
        judged(power.module).power(power.on, at);
        plant.subjects_[power.module]->sends = false;
        of(power.module).power(power.on);
      }
    }
    void operator()(const Reset& reset) const {
      if (of(reset.module).powered()) {
        judged(reset.module).reset(4, at);
        plant.subjects_[reset.module]->sends = false;
        of(reset.module).reset();
      }
    }
    void operator()(const Init& init) const {
      judged(init.module).init(init.asserted, at);
      of(init.module).set_init(init.asserted);
    }
    void operator()(const Input& input) const {
      judged(input.module).input(input.channel, input.level, at);
      of(input.module).set_input(input.channel, input.level);
    }
    void operator()(const Pulse& pulse) const {
      judged(pulse.module).pulse(pulse.channel, pulse.count, at);
      of(pulse.module).pulse_input(pulse.channel, pulse.count);
    }
    void operator()(const Hang& hang) const {
      if (of(hang.module).powered() && !judged(hang.module).likely().hangs(at)) {
        judged(hang.module).hang(hang.time, at);
        of(hang.module).hang(hang.time == Time(0) ? sim::kNever : hang.time);
      }
    }
    void operator()(const TickStops& tick) const {
      if (of(tick.module).powered()) {
        judged(tick.module).tick_stops(at);
        of(tick.module).stop_tick();
      }
    }
    void operator()(const MemoryFails& fails) const {
      judged(fails.module).memory_fails(fails.on, at);
      of(fails.module).memory().fail(fails.on);
    }
    void operator()(const SlotsFail& fails) const {
      judged(fails.module).slots_fail(fails.on, at);
      of(fails.module).slots().fail(fails.on);
    }
    void operator()(const BadImages& bad) const {
      judged(bad.module).start_bad_images(bad.on, at);
      of(bad.module).start_bad_images(bad.on);
    }
    void operator()(const SpoilReply& spoil) const {
      plant.subjects_[spoil.module]->spoils = true;
      plant.subjects_[spoil.module]->late_by = spoil.late_by;
    }
    void operator()(const Noise& noise) const { plant.noise_->set_rates(noise.rates); }
  };
  if (objection_.empty()) {
    std::visit(Play{*this, at, module, judge}, step);
    look();
  }
}

}  // namespace ex9000::world
