// A model of a NOR flash, written from the W25Q16JV data sheet: 7.1 (status registers), 8.2 (instructions),
// "AC electrical characteristics". The expectations in the model make a test fail if the page store uses the
// flash incorrectly, for example if it reads while the flash is busy.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "firmware/bytes.hpp"
#include "firmware/time.hpp"

namespace ex9000::hal::flash {

/// Thrown when the power fails at the time when an operation would end.
struct PowerFailure {};

/// The state in which a power failure leaves the bytes of an operation.
struct Tear {
  enum class Kind {
    Nothing,  ///< all bytes are old
    Prefix,   ///< the first `prefix` bytes are new, the others are old
    Bits,     ///< random bits are new
    Garbage,  ///< erase: all bytes are random; program: as Prefix, but random bits of the others are new
    All,      ///< all bytes are new, but the operation has not ended
  };
  static constexpr Kind kEveryKind[] = {Kind::Nothing, Kind::Prefix, Kind::Bits, Kind::Garbage, Kind::All};

  Kind kind = Kind::Nothing;
  std::size_t prefix = 0;  ///< bytes
  unsigned seed = 0;
};

class FlashChip {
 public:
  /// The address of the store. The model has no bytes outside the store, except those of `add_slots`.
  static constexpr std::uint32_t kBegin = 0x1F'2000;
  static constexpr std::uint32_t kSlots = 0x1'0000;
  static constexpr std::uint32_t kSector = 4096;
  static constexpr std::uint32_t kPageOfFlash = 256;
  static constexpr unsigned kSectorsOfStore = 14;
  static constexpr unsigned kSectorsOfSlots = 64;

  enum class Operation { None, Erase, Program };
  struct Times {
    std::uint64_t erase = 45'000;  ///< us
    std::uint64_t program = 400;   ///< us
  };
  static constexpr Times kLongest{400'000, 3'000};
  static constexpr std::uint64_t kSuspend = 20;  ///< us

  // --- the functions that hal/flash.hpp requires ---

  void start_erase(std::uint32_t address) {
    const std::size_t at = index(address, kSector);
    EXPECT_TRUE(!busy() && !erase_suspended_) << "an erase is ignored now";
    EXPECT_EQ(at % kSector, 0U);
    begin(Operation::Erase, at, times.erase);
    if (at / kSector < kSectorsOfStore) {
      ++erases[at / kSector];
    }
  }
  void start_program(std::uint32_t address, Bytes source) {
    const std::size_t at = index(address, source.size);
    EXPECT_FALSE(busy()) << "a program operation is ignored now";
    EXPECT_EQ(at / kPageOfFlash, (at + source.size - 1) / kPageOfFlash) << "the address wraps";
    EXPECT_TRUE(!erase_suspended_ || at / kSector != erase_at_ / kSector)
        << "the erase of this sector is suspended";
    for (std::size_t i = 0; i < source.size; ++i) {
      if (!is_broken(at + i)) {
        EXPECT_EQ(cells[at + i] & source[i], source[i]) << "the byte is not erased";
      }
      EXPECT_TRUE(weak_[at + i] == 0 || source[i] == 0)
          << "this byte may be unreliable, because an operation on "
             "it was interrupted; expected an erase first";
    }
    source_.assign(source.begin(), source.end());
    begin(Operation::Program, at, times.program);
    ++programs;
  }
  [[nodiscard]] bool busy() const { return operation_ != Operation::None || hangs; }
  void suspend() {
    EXPECT_NE(operation_, Operation::Program) << "a program operation must not be suspended";
    if (operation_ == Operation::Erase && !suspends_at_) {
      EXPECT_GE(now, resumed_ + kSuspend) << "too early after a resume";
      suspends_at_ = now + kSuspend;
      ++suspensions;
    }
  }
  void resume() {
    EXPECT_FALSE(busy()) << "a resume is ignored now";
    if (erase_suspended_) {
      erase_suspended_ = false;
      resumed_ = now;
      operation_ = Operation::Erase;
      at_ = erase_at_;
      left_ = erase_left_;
    }
  }
  void read(std::uint32_t address, MutableBytes destination) {
    const std::size_t at = index(address, destination.size);
    EXPECT_FALSE(busy()) << "a read is ignored now";
    std::copy_n(cells.begin() + static_cast<std::ptrdiff_t>(at), destination.size, destination.data);
    bytes_read += destination.size;
    if (destination.size > 16 && noisy_reads != 0) {
      --noisy_reads;
      destination.data[destination.size / 2] ^= 0x10U;
    }
  }

  // --- functions for the test ---

  /// Adds the sectors from address kSlots on. Their content follows that of the store in `cells`.
  void add_slots() {
    constexpr std::size_t kAll = std::size_t{kSectorsOfStore + kSectorsOfSlots} * kSector;
    cells.resize(kAll, 0xFF);
    weak_.resize(kAll);
  }
  /// Changes the bytes of the slots that an interrupted operation has left, since they need not last.
  void let_slots_decay(unsigned seed) {
    std::mt19937 random(seed);
    for (std::size_t at = std::size_t{kSectorsOfStore} * kSector; at < cells.size(); ++at) {
      cells[at] = static_cast<std::uint8_t>((cells[at] & ~weak_[at]) | (random() & weak_[at]));
    }
  }
  std::uint8_t* slots() { return &cells[std::size_t{kSectorsOfStore} * kSector]; }

  /// Lets time pass. Throws PowerFailure when the operation that `cut` has selected would end.
  void run(std::uint64_t microseconds) {
    for (std::uint64_t i = 0; i < microseconds;) {
      std::uint64_t step = microseconds - i;
      if (operation_ != Operation::None) {
        step = std::min(step, left_);
      }
      if (suspends_at_) {
        step = std::min(step, *suspends_at_ - now);
      }
      now += step;
      i += step;
      if (operation_ != Operation::None) {
        left_ -= step;
        if (left_ == 0) {
          end();
        }
      }
      if (suspends_at_ && now == *suspends_at_) {
        suspend_now();
      }
    }
  }
  [[nodiscard]] Time time() const { return Time(static_cast<std::uint32_t>(now)); }
  [[nodiscard]] Operation operation() const { return operation_; }
  [[nodiscard]] bool erase_suspended() const { return erase_suspended_; }
  /// Returns all operations that have begun, in order.
  [[nodiscard]] const std::vector<Operation>& operations() const { return operations_; }
  /// Returns the number of the erase that is running or suspended. If there is none, returns the number of
  /// the next operation.
  [[nodiscard]] std::size_t earliest_open() const {
    const bool erasing = operation_ == Operation::Erase || erase_suspended_;
    return erasing ? erase_number_ : operations_.size();
  }

  /// Schedules a power cut for the time when operation `number` would end. The first operation of the chip
  /// has the number 0.
  void cut(std::size_t number, Tear tear) {
    cut_ = number;
    tear_ = tear;
  }
  /// Cuts the power now, and cancels a scheduled cut. A suspended erase is cut too, with a random Tear.
  void power_off(Tear tear) {
    cut_.reset();
    std::mt19937 random(tear.seed);
    if (operation_ == Operation::Program) {
      tear_program(tear, random);
    } else if (operation_ == Operation::Erase) {
      tear_erase(at_, tear, random);
    }
    if (erase_suspended_) {
      tear_erase(erase_at_, {Tear::kEveryKind[random() % 5], random() % kSector, 0}, random);
    }
    operation_ = Operation::None;
    erase_suspended_ = false;
    suspends_at_.reset();
  }

  std::vector<std::uint8_t> cells = std::vector<std::uint8_t>(std::size_t{kSectorsOfStore} * kSector, 0xFF);
  Times times;
  bool hangs = false;  ///< while this is true, the flash is busy
  /// The index of the first broken byte in `cells`; SIZE_MAX: no byte is broken. If `broken_keeps` is false,
  /// the lowest bit of each broken byte becomes 0 whenever an operation ends.
  std::size_t broken = SIZE_MAX;
  std::size_t broken_size = 1;
  std::size_t broken_every = SIZE_MAX / 2;  ///< more bytes are broken at this distance
  bool broken_keeps = false;                ///< if true, programming does not change the broken bytes
  unsigned noisy_reads = 0;  ///< number of the next reads of more than 16 bytes that return a wrong bit
  std::uint64_t now = 1;     ///< us
  std::array<unsigned, kSectorsOfStore> erases{};
  unsigned programs = 0;
  unsigned suspensions = 0;
  std::uint64_t bytes_read = 0;

 private:
  [[nodiscard]] std::size_t index(std::uint32_t address, std::size_t size) const {
    const std::size_t in_slots = std::size_t{address} - kSlots + kSectorsOfStore * kSector;
    if (address >= kSlots && in_slots + size <= cells.size()) {
      return in_slots;
    }
    const bool in_store = address >= kBegin && address + size <= kBegin + kSectorsOfStore * kSector;
    EXPECT_TRUE(in_store) << "outside the store: " << address;
    return in_store ? address - kBegin : 0;
  }
  [[nodiscard]] bool is_broken(std::size_t at) const {
    return at >= broken && (at - broken) % broken_every < broken_size;
  }
  void begin(Operation operation, std::size_t at, std::uint64_t time) {
    operation_ = operation;
    at_ = at;
    left_ = time;
    if (operation == Operation::Erase) {
      erase_number_ = operations_.size();
    }
    operations_.push_back(operation);
  }
  void end() {
    if (cut_ == (operation_ == Operation::Erase ? erase_number_ : operations_.size() - 1)) {
      power_off(tear_);
      throw PowerFailure();
    }
    if (operation_ == Operation::Program) {
      for (std::size_t i = 0; i < source_.size(); ++i) {
        if (!broken_keeps || !is_broken(at_ + i)) {
          cells[at_ + i] &= source_[i];
        }
        weak_[at_ + i] &= source_[i];
      }
    } else {
      const auto begin = static_cast<std::ptrdiff_t>(at_);
      std::fill_n(cells.begin() + begin, kSector, std::uint8_t{0xFF});
      std::fill_n(weak_.begin() + begin, kSector, std::uint8_t{0});
    }
    for (std::size_t at = broken; !broken_keeps && at < cells.size(); ++at) {
      cells[at] &= is_broken(at) ? 0xFE : 0xFF;
    }
    operation_ = Operation::None;
  }
  void suspend_now() {
    suspends_at_.reset();
    if (operation_ == Operation::Erase) {
      erase_suspended_ = true;
      erase_at_ = at_;
      erase_left_ = left_;
      operation_ = Operation::None;
    }
  }
  void tear_program(Tear tear, std::mt19937& random) {
    for (std::size_t i = 0; i < source_.size(); ++i) {
      std::uint8_t& cell = cells[at_ + i];
      const auto complete = static_cast<std::uint8_t>(cell & source_[i]);
      const auto some = static_cast<std::uint8_t>(complete | (cell & random()));
      const bool in_prefix = i < tear.prefix;
      weak_[at_ + i] |= static_cast<std::uint8_t>(cell & ~source_[i]);
      switch (tear.kind) {
        case Tear::Kind::Nothing:
          break;
        case Tear::Kind::Prefix:
          cell = in_prefix ? complete : cell;
          break;
        case Tear::Kind::Bits:
          cell = some;
          break;
        case Tear::Kind::Garbage:
          cell = in_prefix ? complete : some;
          break;
        case Tear::Kind::All:
          cell = complete;
          break;
      }
    }
  }
  void tear_erase(std::size_t at, Tear tear, std::mt19937& random) {
    for (std::size_t i = 0; i < kSector; ++i) {
      std::uint8_t& cell = cells[at + i];
      weak_[at + i] = 0xFF;
      switch (tear.kind) {
        case Tear::Kind::Nothing:
          break;
        case Tear::Kind::Prefix:
          cell = i < tear.prefix ? 0xFF : cell;
          break;
        case Tear::Kind::Bits:
          cell = static_cast<std::uint8_t>(cell | random());
          break;
        case Tear::Kind::Garbage:
          cell = static_cast<std::uint8_t>(random());
          break;
        case Tear::Kind::All:
          cell = 0xFF;
          break;
      }
    }
  }

  /// The bits of each byte that an interrupted operation was changing.
  std::vector<std::uint8_t> weak_ = std::vector<std::uint8_t>(std::size_t{kSectorsOfStore} * kSector);
  Operation operation_ = Operation::None;
  std::size_t at_ = 0;
  std::uint64_t left_ = 0;  ///< us until the operation ends
  std::vector<std::uint8_t> source_;
  bool erase_suspended_ = false;
  std::size_t erase_at_ = 0;
  std::uint64_t erase_left_ = 0;
  std::optional<std::uint64_t> suspends_at_;
  std::uint64_t resumed_ = 0;
  std::vector<Operation> operations_;
  std::size_t erase_number_ = 0;
  std::optional<std::size_t> cut_;
  Tear tear_;
};

}  // namespace ex9000::hal::flash
