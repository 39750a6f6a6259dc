// An AT24C64 on its I2C bus. Data sheet: Atmel doc. 0336, "device operation", "write operations", "read
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

  /// Connects the chip to `clock` and `data`, with a pull-up on each. `contents` holds the stored bytes and
  /// must outlive this object.
  EepromChip(Timeline& timeline, Net& clock, Net& data, std::vector<std::uint8_t>& contents);

  /// Sets how long the chip programs a page. The default is 5 ms; the data sheet permits at most 10 ms.
  void set_programming_time(Instant time) { programming_time_ = time; }
  /// Removes the chip from its wires, with or without the pull-ups.
  void remove(bool pull_ups_too);
  /// Makes the supply fail. If a page is being programmed, the elapsed time determines how many of its first
  /// bytes are complete; the next byte is spoiled, and the rest keep their old values. The chip abandons a
  /// transfer in progress.
  void lose_power();
  /// From now on, makes the chip acknowledge at most `bytes` bytes after each START, including the device
  /// address and the memory address.
  void refuse_after(unsigned bytes) { patience_ = bytes; }

  /// Makes a byte worn out: from its next write on, the bits that are set in `bits` have their value in
  /// `stuck`. The chip still acknowledges writes to the byte.
  void wear_out(std::uint16_t place, std::uint8_t bits, std::uint8_t stuck) { worn_[place] = {bits, stuck}; }
  void renew() { worn_.clear(); }
  /// Returns the number of times that a worn-out byte did not take the programmed value.
  [[nodiscard]] unsigned spoiled() const { return spoiled_; }

  /// Sets the function to call after each START and STOP on the bus, after each byte that the chip receives
  /// or sends, and when a page has been programmed. Replaces the previous function; null removes it.
  void on_event(std::function<void()> act) { on_event_ = std::move(act); }

  [[nodiscard]] bool programming() const { return programmed_.is_set(); }
  /// A byte of the memory: its address and its new value.
  struct Cell {
    std::uint16_t place;
    std::uint8_t value;
  };
  /// Returns the bytes of the page write in progress, each once, in the order in which they were first sent;
  /// empty if no page write is in progress.
  [[nodiscard]] std::vector<Cell> being_programmed() const;
  [[nodiscard]] bool pulls_data() const { return data_.driven_by(End::Device) == Drive::Low; }
  /// A completed page write: its first address, the number of bytes that were programmed, and the time at
  /// which the programming began.
  struct Programmed {
    std::uint16_t address;
    std::size_t size;
    Instant at;
  };
  [[nodiscard]] const std::vector<Programmed>& programmed() const { return programmed_pages_; }
  /// Returns the number of times that the chip was addressed during a page write.
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
  /// Programs the first `size` bytes of the received page into the memory.
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
