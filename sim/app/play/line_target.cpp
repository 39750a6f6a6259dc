#include "sim/app/play/line_target.hpp"

#include <algorithm>
#include <utility>

#include "sim/app/setup/line_factory.hpp"
#include "sim/files_and_ports/files/eeprom_file.hpp"
#include "sim/notation/actions.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::play {

namespace {

constexpr std::chrono::milliseconds kComingUp{100};

}  // namespace

Memories read_memories(const sim::Setup& setup) {
  Memories memories;
  for (const sim::LineSetup& line : setup.lines) {
    for (const sim::ModuleSpec& module : line.modules) {
      memories.push_back(sim::with_place(sim::place_of(module.places, "eeprom"), [&] {
        return module.eeprom.empty() ? std::nullopt : sim::read_eeprom_file(module.eeprom);
      }));
    }
  }
  return memories;
}

LineTarget::LineTarget(const sim::Setup& setup, const Memories& memories, PlayObserver* observer)
    : observer_(observer) {
  auto next = memories.begin();
  for (const sim::LineSetup& line : setup.lines) {
    add_line(line, next, setup.seed + lines_.size());
    next += static_cast<std::ptrdiff_t>(line.modules.size());
  }
}

void LineTarget::start(const Model& model, const Settings* preset) {
  sim::LineSetup setup;
  setup.modules.push_back(sim::factory_fresh(model));
  if (preset != nullptr) {
    setup.modules[0].settings = *preset;
  }
  const Memories none(1);
  add_line(setup, none.begin(), 1);
}

void LineTarget::add_line(const sim::LineSetup& setup, Memories::const_iterator memories,
                          std::uint64_t seed) {
  const std::size_t index = lines_.size();
  names_.push_back(setup.name);
  heard_.emplace_back();
  lines_.push_back(sim::make_line(
      setup, [this, index](std::uint8_t byte, ByteStatus /*status*/) { heard_[index].push_back(byte); }));
  sim::Line& line = *lines_.back();
  for (std::size_t i = 0; i < line.size(); ++i, ++memories) {
    if (*memories) {
      line.module(i).memory().contents() = **memories;
    }
  }
  line.come_up();
  line.master().set_mode(sim::first_mode(setup, line));
  line.configure_faults(seed, observer_ == nullptr ? nullptr : observer_->line_started(line, setup.name));
  sim::begin_programs(line, setup);
}

void LineTarget::run_until(sim::VirtualTime until) {
  for (const auto& line : lines_) {
    line->wires().run_until(until);
  }
  if (observer_ != nullptr) {
    observer_->time_reached(until);
  }
}

void LineTarget::send(const Bytes& bytes) {
  sim::Master& master = chosen().master();
  master.send(bytes.data(), bytes.size());
  while (master.sending()) {
    run_until(chosen().wires().next());
  }
}

Bytes LineTarget::receive(std::size_t count, std::chrono::milliseconds patience) {
  Bytes& heard = heard_[line_];
  std::size_t had = heard.size();
  sim::VirtualTime gives_up = now() + patience;
  while (heard.size() < count && chosen().wires().next() <= gives_up) {
    run_until(chosen().wires().next());
    if (heard.size() != had) {
      had = heard.size();
      gives_up = now() + patience;
    }
  }
  return std::exchange(heard, {});
}

Bytes LineTarget::listen(std::chrono::nanoseconds time) {
  run_until(now() + time);
  return std::exchange(heard_[line_], {});
}

void LineTarget::on_module(sim::Words action) {
  action.insert(action.begin(), std::to_string(module_ + 1));
  sim::act({{"", chosen()}}, action);
}

void LineTarget::power(bool on) {
  on_module({"power", sim::on_off_text(on)});
  if (on) {
    run_until(now() + kComingUp);
  }
}

void LineTarget::reset() {
  on_module({"reset"});
  run_until(now() + kComingUp);
}

void LineTarget::set_init(bool asserted) { on_module({"init", sim::on_off_text(asserted)}); }

void LineTarget::set_input(unsigned channel, bool level) {
  on_module({"input", std::to_string(channel), sim::on_off_text(level)});
}

void LineTarget::pulse_input(unsigned channel, std::uint32_t count) {
  on_module({"pulse", std::to_string(channel), "x" + std::to_string(count)});
}

Led LineTarget::led(Led /*expected*/) {
  // No virtual time passes, so the check does not delay other steps. StatusLed's unit tests check flashing.
  if (module().powered() && module().module().led_pattern() == StatusLed::Pattern::HostTimeout) {
    return Led::Flashing;
  }
  return module().led_lit() ? Led::On : Led::Off;
}

void LineTarget::choose_module(std::size_t position) {
  std::size_t index = position;
  for (std::size_t line = 0; line < lines_.size(); ++line) {
    if (index < lines_[line]->size()) {
      turn_to(line, index);
      return;
    }
    index -= lines_[line]->size();
  }
  sim::fail("no module " + std::to_string(position + 1) + "; expected a position from 1 to " +
            std::to_string(position - index));
}

void LineTarget::choose_line(const std::string& name) {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found != names_.end()) {
    turn_to(static_cast<std::size_t>(found - names_.begin()), 0);
    return;
  }
  const std::string names = sim::joined(names_, ", ");
  sim::fail("no line '" + name + "'; " +
            (names.empty() ? "the only line has no name; remove the step" : "expected one of " + names));
}

/// If the line changes, discards what the master of the new one has received so far.
void LineTarget::turn_to(std::size_t line, std::size_t module) {
  if (line != line_) {
    heard_[line].clear();
  }
  line_ = line;
  module_ = module;
}

std::string LineTarget::act(const sim::Words& words) {
  sim::LinesInUse lines;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    lines.push_back({names_[i], *lines_[i]});
  }
  const bool of_a_module = words[0].find_first_not_of("0123456789") == std::string::npos;
  return sim::act(of_a_module ? lines : sim::LinesInUse{lines[line_]}, words);
}

}  // namespace ex9000::play
