// Tests how the firmware reads settings that earlier firmware stored: wire.md section 8. The files in
// stored_bytes/ also contain settings in the present layout.
#include "firmware/settings/old_layouts.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/settings/places.hpp"
#include "tests/firmware/settings/settings_store_bench.hpp"
#include "tests/firmware/settings/stored_bytes.hpp"

namespace ex9000 {
namespace {

std::optional<StoredSettings> read(const Model& model, const std::vector<std::uint8_t>& memory,
                                   std::size_t place) {
  return read_old_layout(model, {memory.data() + place, kOldCopySize});
}

/// Reads each file with the firmware and with an independent reader, and compares both results with the
/// settings that were stored. The firmware must not write when it reads.
TEST(StoredBytes, AreReadWithoutAWriteAsTheSettingsThatWereStored) {
  for (const StoredBytes& stored : all_stored_bytes()) {
    FakeMemory memory;
    memory.cells = stored.memory;
    const Boot run(memory, *stored.model);
    EXPECT_EQ(run.found(), Found::Settings) << stored.file;
    EXPECT_TRUE(run.stored() == stored.settings) << stored.file;
    EXPECT_TRUE(settings_from(*stored.model, stored.memory.data()) == stored.settings) << stored.file;
    EXPECT_TRUE(memory.writes.empty()) << stored.file;
  }
}

TEST(StoredBytes, TheModulesAddressIsKeptWhenAnotherSettingIsStored) {
  for (const StoredBytes& stored : all_stored_bytes()) {
    FakeMemory memory;
    memory.cells = stored.memory;
    Settings changed = stored.settings;
    changed.watchdog_timeout = 0x11;
    ASSERT_TRUE(Boot(memory, *stored.model).save(changed)) << stored.file;
    EXPECT_EQ(Boot(memory, *stored.model).stored().address, stored.settings.address) << stored.file;
  }
}

TEST(StoredBytes, SettingsOfAnotherModelAreNotRead) {
  for (const StoredBytes& stored : all_stored_bytes()) {
    for (const Model& each : kModels) {
      if (&each != stored.model) {
        FakeMemory memory;
        memory.cells = stored.memory;
        EXPECT_EQ(Boot(memory, each).found(), Found::Unreadable) << stored.file << " as " << each.designation;
      }
    }
  }
}

/// Corrupts each byte of each good copy of layouts 1 and 2 in the files, one byte at a time.
TEST(OldLayouts, AnyCorruptionOfASingleByteIsDetected) {
  for (const StoredBytes& stored : all_stored_bytes()) {
    for (const std::size_t place : {0x00U, 0x20U}) {
      const std::optional<StoredSettings> good = read(*stored.model, stored.memory, place);
      const std::size_t size = good && good->edition.layout == 1 ? 25 : kOldCopySize;
      for (std::size_t at = 0; good && at < size; ++at) {
        for (unsigned value = 0; value < 256; ++value) {
          std::vector<std::uint8_t> memory = stored.memory;
          memory[place + at] = static_cast<std::uint8_t>(value);
          if (memory != stored.memory) {
            EXPECT_FALSE(read(*stored.model, memory, place)) << stored.file << ", byte " << at;
          }
        }
      }
    }
  }
}

TEST(OldLayouts, CopiesWithTheInvalidatingZerosAreNotRead) {
  for (const StoredBytes& stored : all_stored_bytes()) {
    for (const std::size_t place : {0x00U, 0x20U}) {
      std::vector<std::uint8_t> memory = stored.memory;
      std::fill_n(memory.begin() + static_cast<std::ptrdiff_t>(place + kOldInvalidatedFrom),
                  kOldInvalidatedSize, std::uint8_t{0});
      EXPECT_FALSE(read(*stored.model, memory, place)) << stored.file;
    }
  }
}

/// The check is in bytes 21 to 24 of layout 1 and in bytes 24 to 27 of layout 2.
TEST(OldLayouts, TheInvalidatingZerosIncludeTheChecksOfBothLayouts) {
  EXPECT_LE(kOldInvalidatedFrom, 21U);
  EXPECT_GE(kOldInvalidatedFrom + kOldInvalidatedSize, 28U);
}

TEST(OldLayouts, ACopyOfLayout2WithImpossibleSettingsIsNotRead) {
  struct Bad {
    const char* what;
    std::size_t at;
    std::uint8_t value;
  };
  for (const Bad& bad : {Bad{"Modbus address", 0, 0}, Bad{"Modbus address", 0, 248}, Bad{"baud code", 1, 2},
                         Bad{"baud code", 1, 0x0B}, Bad{"format", 2, 0x20}, Bad{"protocol", 3, 2},
                         Bad{"watchdog enabled", 5, 2}, Bad{"timeout status", 6, 2}, Bad{"name", 8, 0x0D},
                         Bad{"no name", 15, 0}, Bad{"long name", 15, 7}, Bad{"longest name", 15, 255},
                         Bad{"power-on value", 17, 0x20}, Bad{"safe value", 19, 0x80}}) {
    FakeMemory memory;
    put_old(memory, 0, factory(), 1);
    ASSERT_TRUE(read(the_model(), memory.cells, 0));
    memory.cells[bad.at] = bad.value;
    StoredCopy::seal(storing_model(the_model()), memory.cells.data(), 0);
    EXPECT_FALSE(read(the_model(), memory.cells, 0)) << bad.what;
  }
}

}  // namespace
}  // namespace ex9000
