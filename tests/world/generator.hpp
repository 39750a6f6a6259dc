// Builds a plant and its history from one number.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "tests/oracles/reference/random.hpp"
#include "tests/world/plant.hpp"
#include "tests/world/requests.hpp"

namespace ex9000::world {

class Generator {
 public:
  Generator(std::uint64_t seed, const Requests& requests);

  [[nodiscard]] const Setup& setup() const { return setup_; }
  /// The next step, given what the plant is in.
  Step next(const Plant& plant);

 private:
  Member member();
  [[nodiscard]] bool often(unsigned what, unsigned times);
  Bytes request(std::size_t index, const Possible& target);
  Send send(std::size_t index, const Possible& target);
  static Time time_of(const Send& send);
  Step fault(unsigned what, std::size_t index, const Plant& plant);
  void add(unsigned what, std::size_t index, const Plant& plant);
  void disturb(std::size_t index, const Plant& plant);
  void aim_at(Time expiry, std::size_t index, const Plant& plant);
  void update(std::size_t index, const Plant& plant);
  void ask(std::size_t index, const Plant& plant);
  void decide(const Plant& plant);

  const Requests& requests_;
  reference::Random random_;
  unsigned left_out_;  ///< a mask: each run leaves out a random part
  unsigned loud_;      ///< a mask: and has more of another
  Setup setup_;
  std::vector<Requests::Place> places_;  ///< for each module
  std::vector<Requests::Image> images_;  ///< for each module
  std::deque<Step> plan_;                ///< the next steps
  std::optional<std::size_t> aim_;       ///< the module that gets the next step
};

}  // namespace ex9000::world
