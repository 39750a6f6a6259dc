// Tests that the firmware reads the settings in stored_bytes/: wire.md section 8.
#include "tests/firmware/settings/stored_bytes.hpp"

#include <gtest/gtest.h>

#include "tests/hal/eeprom/two_places_bench.hpp"

namespace ex9000 {
namespace {

/// Reads each file with the firmware and with an independent reader, and compares both results with the
/// settings that were stored. The firmware must not write when it reads.
TEST(StoredBytes, AreReadWithoutAWriteAsTheSettingsThatWereStored) {
  for (const StoredBytes& stored : all_stored_bytes()) {
    FakeEeprom memory;
    memory.cells = stored.memory;
    const Boot run(memory, *stored.model);
    EXPECT_EQ(run.source(), SettingsSource::Good) << stored.file;
    EXPECT_TRUE(run.stored() == stored.settings) << stored.file;
    EXPECT_TRUE(settings_from(*stored.model, stored.memory.data()) == stored.settings) << stored.file;
    EXPECT_TRUE(memory.writes.empty()) << stored.file;
  }
}

TEST(StoredBytes, TheModulesAddressIsKeptWhenAnotherSettingIsStored) {
  for (const StoredBytes& stored : all_stored_bytes()) {
    FakeEeprom memory;
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
        FakeEeprom memory;
        memory.cells = stored.memory;
        EXPECT_EQ(Boot(memory, each).source(), SettingsSource::NoneGood)
            << stored.file << " as " << each.designation;
      }
    }
  }
}

}  // namespace
}  // namespace ex9000
