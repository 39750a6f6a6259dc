// Judges one module by what its wires and terminals show.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/world/possible.hpp"

namespace ex9000::world {

/// Keeps all states that the module may be in. What happens to the module changes each of them, and what it
/// does rules some of them out. If none is left, the module has done something that no reading of the
/// specification permits. Call the functions in the order of their times.
class Judge {
 public:
  using Object = std::function<void(const std::string& objection)>;

  Judge(const reference::ModelRow& row, Object object);
  Judge(const Judge&) = delete;
  Judge& operator=(const Judge&) = delete;

  // --- what happens to the module ---

  void set_serial_number_of_board(unsigned number);
  void store(const reference::Stored& stored);
  void power(bool on, Time now);
  void reset(unsigned reason, Time now);
  void hang(Time time, Time now);
  void tick_stops(Time now);
  void init(bool asserted, Time now);
  void memory_fails(bool fails, Time now);
  void slots_fail(bool fails, Time now);
  void start_bad_images(bool bad, Time now);
  void input(unsigned channel, bool level, Time now);
  void pulse(unsigned channel, std::uint32_t count, Time now);
  void hear(std::uint8_t byte, bool good, Time end);

  // --- what the module does ---

  void drive(unsigned outputs, Time now);
  void light(bool on, Time now);
  void listen(unsigned rate, LineFormat format, Time now);
  void reply(const Bytes& bytes, Time begins);
  void replied(Time end);
  /// Nothing else has happened until now.
  void pass(Time now);

  /// Returns one of the states.
  [[nodiscard]] const Possible& likely() const { return all_.front(); }
  [[nodiscard]] std::size_t size() const { return all_.size(); }
  /// The module may be in too many states to be judged.
  [[nodiscard]] bool gave_up() const { return gave_up_; }

 private:
  template <class Change>
  void each(Time now, Change change);
  void fork(Time now, const std::string& what,
            const std::function<std::vector<Possible>(const Possible&)>& after);
  void replace(std::vector<Possible> by, Time now, const std::string& what);

  std::vector<Possible> all_;
  Object object_;
  Time since_{0};
  unsigned outputs_ = 0;
  bool lit_ = false;
  Time lit_since_{0};
  bool gave_up_ = false;
};

}  // namespace ex9000::world
