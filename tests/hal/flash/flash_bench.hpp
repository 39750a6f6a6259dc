// A page store on the model of a flash, from one reset to the next.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "hal/flash/page_store.hpp"
#include "hal/memory.hpp"
#include "tests/hal/flash/flash_chip.hpp"

namespace ex9000::hal::flash {

/// Passes the calls of the store to a chip, which must outlive the store.
struct FlashPort {
  FlashChip* chip = nullptr;

  void start_erase(std::uint32_t address) const { chip->start_erase(address); }
  void start_program(std::uint32_t address, Bytes source) const { chip->start_program(address, source); }
  [[nodiscard]] bool busy() const { return chip->busy(); }
  void suspend() const { chip->suspend(); }
  void resume() const { chip->resume(); }
  void read(std::uint32_t address, MutableBytes destination) const { chip->read(address, destination); }
};

using Store = PageStore<FlashPort, FlashChip::kBegin>;
static_assert(kIsMemory<Store>);

using Page = std::array<std::uint8_t, kPage>;
constexpr std::size_t kStoreSize = kPages * kPage;

/// Returns a page that differs for each `number`.
inline Page numbered(unsigned number) {
  Page page{};
  for (std::size_t i = 0; i < kPage; ++i) {
    page[i] = static_cast<std::uint8_t>((number >> (8U * (i % 4))) + i);
  }
  return page;
}

/// A page store with its main loop. `read`, `write` and `page` run the main loop until their result is
/// available.
class Session {
 public:
  /// Begins with a new store, as a reset does. `chip` must outlive this object.
  explicit Session(FlashChip& chip) : chip_(chip) { store_.flash().chip = &chip; }
  /// Continues with a copy of `store`. `chip` is the chip of `store` or a copy of that chip.
  Session(FlashChip& chip, const Store& store) : chip_(chip), store_(store) { store_.flash().chip = &chip; }

  bool read(std::size_t address, std::vector<std::uint8_t>& into) {
    store_.start_read(static_cast<std::uint16_t>(address), {into.data(), into.size()}, chip_.time());
    return finish();
  }
  bool write(std::size_t address, Bytes source) {
    store_.start_write(static_cast<std::uint16_t>(address), source, chip_.time());
    return finish();
  }
  bool write(std::size_t page, const Page& content) {
    return write(page * kPage, Bytes{content.data(), content.size()});
  }
  Page page(std::size_t number) {
    std::vector<std::uint8_t> bytes(kPage);
    EXPECT_TRUE(read(number * kPage, bytes)) << "page " << number;
    Page page{};
    std::copy(bytes.begin(), bytes.end(), page.begin());
    return page;
  }

  /// Runs the main loop until the job is over. Returns whether the job succeeded. If the job takes more than
  /// 1 s, fails the test and returns false. Sets `latency` if the job ends in time.
  bool finish() {
    const std::uint64_t began = chip_.now;
    while (store_.busy()) {
      turn();
      if (chip_.now - began > 1'000'000) {
        ADD_FAILURE() << "the job does not end";
        return false;
      }
    }
    latency = chip_.now - began;
    return store_.succeeded();
  }
  /// Runs the main loop for at least `microseconds`.
  void run(std::uint64_t microseconds) {
    for (const std::uint64_t end = chip_.now + microseconds; chip_.now < end;) {
      turn();
    }
  }
  /// Runs the main loop until all free sectors are erased.
  void settle() {
    constexpr int kQuietTurns = 6;
    for (int quiet = 0; quiet < kQuietTurns; ++quiet) {
      turn();
      if (chip_.busy() || chip_.erase_suspended()) {
        quiet = 0;
      }
    }
  }
  /// Calls `poll` every 10 us until it returns false. Then lets kMemoryPollPeriod pass.
  void turn() {
    constexpr std::uint64_t kTurn = 10;  // us
    while (store_.poll(chip_.time())) {
      chip_.run(kTurn);
    }
    chip_.run(kMemoryPollPeriod.microseconds());
  }

  Store& store() { return store_; }
  std::uint64_t latency = 0;  ///< duration of the last job in us

 private:
  FlashChip& chip_;
  Store store_;
};

}  // namespace ex9000::hal::flash
