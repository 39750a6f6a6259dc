// One line with its master's end and its modules.
#pragma once

#include <memory>
#include <vector>

#include "sim/bus.hpp"
#include "sim/master.hpp"
#include "sim/module.hpp"
#include "sim/module_spec.hpp"

namespace ex9000::sim {

/// Station 0 is the master; modules follow in the order given. All have their supply on from the start.
class Line {
 public:
  Line(const std::vector<ModuleSpec>& modules, std::uint32_t baud, InterCharacterGap gap,
       Master::Receive receive);

  VirtualClock& clock() { return clock_; }
  Bus& bus() { return bus_; }
  Master& master() { return master_; }
  [[nodiscard]] std::size_t size() const { return modules_.size(); }
  SimulatedModule& module(std::size_t index) { return *modules_[index]; }

 private:
  VirtualClock clock_;
  Bus bus_{clock_};
  Master master_;
  std::vector<std::unique_ptr<SimulatedModule>> modules_;
};

}  // namespace ex9000::sim
