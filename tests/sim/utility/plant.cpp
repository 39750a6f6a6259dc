#include "tests/sim/utility/plant.hpp"

#include <algorithm>
#include <deque>
#include <utility>

#include "sim/notation/module_notation.hpp"
#include "sim/utility/command/program.hpp"

namespace ex9000::utility {

class Plant::Line final : public Connection {
 public:
  Line(Plant& plant, hal::SerialMode mode) : plant_(plant) { set_mode(mode); }

  void set_mode(hal::SerialMode mode) override {
    plant_.target_.set_baud(mode.baud);
    plant_.target_.set_format(mode.format);
  }
  void send(const Data& bytes) override {
    plant_.sent.push_back(bytes);
    plant_.heard_ = 0;
    if (plant_.sends(bytes)) {
      plant_.target_.send(bytes);
    }
    if (plant_.echoes) {
      echo_ = bytes;
    }
  }
  Data receive(Time patience) override {
    if (!echo_.empty()) {
      return std::exchange(echo_, {});
    }
    const Time end = now() + patience;
    while ((arrived_.empty() || arrived_.front().first > now()) && now() < end) {
      hear_until(arrived_.empty() ? end : std::min(end, arrived_.front().first));
    }
    Data bytes;
    for (; !arrived_.empty() && arrived_.front().first <= now(); arrived_.pop_front()) {
      bytes.push_back(arrived_.front().second);
    }
    return bytes;
  }
  Time now() override { return plant_.now(); }

 private:
  /// Or until the next byte.
  void hear_until(Time end) {
    const auto whole = std::chrono::duration_cast<std::chrono::milliseconds>(end - now());
    Data bytes = whole > Time(0) ? plant_.target_.receive(1, whole) : Data();
    if (bytes.empty()) {
      bytes = plant_.target_.listen(end - now());
    }
    for (const std::uint8_t byte : bytes) {
      const auto changed = plant_.hears ? plant_.hears(plant_.heard_, byte) : std::optional(byte);
      ++plant_.heard_;
      if (changed) {
        arrived_.emplace_back(now() + plant_.delay, *changed);
      }
    }
  }

  Plant& plant_;
  Data echo_;
  std::deque<std::pair<Time, std::uint8_t>> arrived_;  ///< and when the program gets it
};

sim::Setup Plant::setup_of(const std::vector<std::string>& modules) {
  sim::Setup setup;
  setup.lines.emplace_back();
  for (const std::string& module : modules) {
    setup.lines[0].modules.push_back(sim::parse_module_spec(module));
  }
  sim::complete(setup);
  return setup;
}

Plant::Plant(const std::vector<std::string>& modules)
    : target_(setup_of(modules), play::Memories(modules.size())) {}

void Plant::clear() {
  output_.str("");
  error_.str("");
  sent.clear();
}

Environment Plant::environment() {
  return {[this](const Port& /*port*/, hal::SerialMode mode) { return std::make_unique<Line>(*this, mode); },
          output_, error_};
}

int Plant::run(const std::vector<std::string>& words) {
  std::vector<const char*> argv{"ex9000"};
  for (const std::string& word : words) {
    argv.push_back(word.c_str());
  }
  clear();
  Environment environment = this->environment();
  return run_program(static_cast<int>(argv.size()), argv.data(), environment);
}

}  // namespace ex9000::utility
