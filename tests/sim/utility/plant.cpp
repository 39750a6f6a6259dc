#include "tests/sim/utility/plant.hpp"

#include <algorithm>
#include <deque>
#include <utility>

#include "sim/notation/module_notation.hpp"

namespace ex9000::utility {

class Plant::Line final : public TargetLine {
 public:
  Line(Plant& plant, hal::SerialMode mode)
      : TargetLine(plant.target_, mode, [&plant] { return plant.now(); }), plant_(plant) {}

  void send(const Data& bytes) override {
    plant_.sent.push_back(bytes);
    plant_.heard_ = 0;
    const std::optional<Data> reply = plant_.replies ? plant_.replies(bytes) : std::nullopt;
    if (plant_.sends(bytes) && !reply) {
      TargetLine::send(bytes);
    }
    if (plant_.echoes) {
      at_once_.insert(at_once_.end(), bytes.begin(), bytes.end());
    }
    if (reply) {
      at_once_.insert(at_once_.end(), reply->begin(), reply->end());
    }
  }
  Data receive(Time patience) override {
    if (!at_once_.empty()) {
      return std::exchange(at_once_, {});
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

 private:
  /// Or until the next byte.
  void hear_until(Time end) {
    for (const std::uint8_t byte : TargetLine::receive(end - now())) {
      const auto changed = plant_.hears ? plant_.hears(plant_.heard_, byte) : std::optional(byte);
      ++plant_.heard_;
      if (changed) {
        arrived_.emplace_back(now() + plant_.delay, *changed);
      }
    }
  }

  Plant& plant_;
  Data at_once_;                                       ///< the program gets it, without a time
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
    : target_(setup_of(modules), play::Memories(modules.size())),
      program_([this](hal::SerialMode mode) { return std::make_unique<Line>(*this, mode); }) {}

void Plant::clear() {
  program_.clear();
  sent.clear();
}

int Plant::run(const std::vector<std::string>& words) {
  sent.clear();
  return program_.run(words);
}

}  // namespace ex9000::utility
