// An AT24C64 on its two wires. Data sheet: Atmel doc. 0336, "device operation", "write operations", "read
// operations".
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "tests/mcu_model/net.hpp"
#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

class EepromChip {
 public:
  static constexpr std::size_t kSize = 8192;
  static constexpr std::size_t kPage = 32;

  /// On these wires, with a pull-up on each. `contents` outlive it: they are what lasts.
  EepromChip(Timeline& timeline, Net& clock, Net& data, std::vector<std::uint8_t>& contents);

  /// How long it programs a page: 10 ms at most, typically half of it.
  void set_programming_time(Instant time) { programming_time_ = time; }
  /// Takes it off its wires; the pull-ups too, or they stay.
  void remove(bool pull_ups_too);
  /// The supply fails: a page that is being programmed has its first bytes, one that is neither, and the rest
  /// as it was, by how long it had; what was on the bus is forgotten.
  void lose_power();
  /// From now on it takes no more than this many bytes of a transfer, the address among them.
  void refuse_after(unsigned bytes) { patience_ = bytes; }

  /// A byte that is worn out: from the next time that it is programmed on these bits stay at `stuck`, though
  /// the chip acknowledges all that it is sent.
  void wear_out(std::uint16_t place, std::uint8_t bits, std::uint8_t stuck) { worn_[place] = {bits, stuck}; }
  void renew() { worn_.clear(); }
  /// Bytes that were programmed and have become something else.
  [[nodiscard]] unsigned spoiled() const { return spoiled_; }

  /// Told behind each START, byte and STOP on the bus, and when a page is programmed. One, or null.
  void on_event(std::function<void()> act) { on_event_ = std::move(act); }

  [[nodiscard]] bool programming() const { return programmed_.is_set(); }
  /// A byte of the array, and what it becomes.
  struct Cell {
    std::uint16_t place;
    std::uint8_t value;
  };
  /// What is being programmed, in the order in which it was sent; empty: nothing is.
  [[nodiscard]] std::vector<Cell> being_programmed() const;
  [[nodiscard]] bool pulls_data() const { return data_.driven_by(End::Device) == Drive::Low; }
  /// Pages programmed, of how many bytes each; and where they began.
  struct Programmed {
    std::uint16_t address;
    std::size_t size;
    Instant at;
  };
  [[nodiscard]] const std::vector<Programmed>& programmed() const { return programmed_pages_; }
  /// Times that it was addressed while it programmed.
  [[nodiscard]] unsigned polls_refused() const { return polls_refused_; }

 private:
  enum class Step : std::uint8_t { Off, Idle, Addressed, AddressHigh, AddressLow, Writing, Reading };

  void clock_changed();
  void data_changed();
  void byte_taken();
  void pull(bool low) { data_.drive(End::Device, low ? Drive::Low : Drive::Nothing); }
  void begin_programming();
  void put_next_bit();
  void tell() const {
    if (on_event_) {
      on_event_();
    }
  }
  /// The first `size` bytes of what was written go to the array.
  void commit(std::size_t size);
  void program(std::uint16_t place, std::uint8_t value);

  Timeline& timeline_;
  Net& clock_;
  Net& data_;
  std::vector<std::uint8_t>& contents_;
  Instant programming_time_ = std::chrono::milliseconds(5);
  unsigned patience_ = 0xFFFF'FFFF;

  Step step_ = Step::Idle;
  bool clock_level_ = true;
  bool data_level_ = true;
  unsigned bit_ = 0;
  bool acknowledging_ = false;
  std::uint8_t byte_ = 0;
  unsigned bytes_ = 0;
  std::uint16_t address_ = 0;
  std::array<std::uint8_t, kPage> page_{};
  std::vector<std::uint16_t> order_;
  Instant began_{0};
  Alarm programmed_;
  std::vector<Programmed> programmed_pages_;
  unsigned polls_refused_ = 0;
  struct Worn {
    std::uint8_t bits;
    std::uint8_t stuck;
  };
  std::map<std::uint16_t, Worn> worn_;
  unsigned spoiled_ = 0;
  std::function<void()> on_event_;
};

}  // namespace ex9000::registers
