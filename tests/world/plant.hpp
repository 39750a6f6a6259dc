// A line with modules, and a judge for each of them.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/virtual_line/faults/noise.hpp"
#include "sim/virtual_line/line/line.hpp"
#include "tests/world/judge.hpp"
#include "tests/world/steps.hpp"

namespace ex9000::world {

class Plant {
 public:
  explicit Plant(const Setup& setup);
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;
  ~Plant();

  void play(const Step& step);
  /// Empty: everything was permitted so far.
  [[nodiscard]] const std::string& objection() const { return objection_; }
  [[nodiscard]] std::size_t size() const { return subjects_.size(); }
  [[nodiscard]] const Possible& likely(std::size_t module) const;
  [[nodiscard]] bool powered(std::size_t module) const { return line_->module(module).powered(); }
  [[nodiscard]] Time now() const { return line_->clock().virtual_now(); }
  [[nodiscard]] bool gave_up() const { return gave_up_; }
  [[nodiscard]] std::size_t widest() const { return widest_; }
  [[nodiscard]] std::uint64_t requests() const { return requests_; }
  [[nodiscard]] std::uint64_t replies() const { return replies_; }
  /// How often each state of an update has begun.
  using Updates = std::array<std::uint64_t, 7>;
  [[nodiscard]] const Updates& updates() const { return updates_; }

 private:
  struct Subject;

  void run_until(Time until);
  void look();

  std::unique_ptr<sim::Line> line_;
  std::vector<std::unique_ptr<Subject>> subjects_;
  std::unique_ptr<sim::Noise> noise_;
  std::vector<std::unique_ptr<sim::Master>> others_;
  std::string objection_;
  bool gave_up_ = false;
  std::size_t widest_ = 0;
  std::uint64_t requests_ = 0;
  std::uint64_t replies_ = 0;
  Updates updates_{};
};

}  // namespace ex9000::world
