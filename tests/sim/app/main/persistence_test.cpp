// Tests how the program creates and uses the file of a module's EEPROM, and what it does with a file that
// contains no settings of the module.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <random>
#include <string>

#include "firmware/model/baud.hpp"
#include "sim/text/values.hpp"
#include "tests/firmware/settings/stored_bytes.hpp"
#include "tests/sim/app/main/persistent_simulator.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/hang.hpp"

namespace ex9000::system {
namespace {

namespace fs = std::filesystem;

// --- the program creates a file, and uses an existing file ---

TEST(Persistence, AMissingFileIsCreatedFromThePresetsAndKeptAfterTheProgramEnds) {
  for (const int signal : {SIGKILL, SIGTERM}) {
    const Directory directory;
    std::string status;
    {
      Simulator first({"EX9042D-M@1A,protocol=ascii,checksum=on,name=PUMP" + image_in(directory)});
      EXPECT_TRUE(has(first.greeting(), directory / "image")) << first.greeting();
      EXPECT_EQ(bytes_of_file(directory / "image").size(), kImageSize);
      status = first.tell("1 status");
      EXPECT_TRUE(has(status, "address=1A")) << status;
      first.process().end(signal);
    }
    EXPECT_EQ(directory.contents().size(), 1U);
    Simulator second({"EX9042D-M" + image_in(directory)});
    EXPECT_EQ(second.tell("1 status"), status);
    EXPECT_TRUE(has(second.greeting(), "EX9042D-M at 1A, ASCII")) << second.greeting();
    EXPECT_EQ(second.ask("$1AME3"), "!1APUMPD5");
  }
}

// Each image contains what this firmware or an earlier version of it has stored.
TEST(Persistence, AModuleUsesTheSettingsInAFileOfThisOrEarlierFirmwareAndDoesNotWriteTheFile) {
  for (const StoredBytes& stored : all_stored_bytes()) {
    const Directory directory;
    std::string image(kImageSize, '\xFF');
    std::copy(stored.memory.begin(), stored.memory.end(), image.begin());
    write_file(directory / "image", image);
    Simulator simulator({std::string(stored.model->designation) + image_in(directory)});
    const std::string status = simulator.tell("1 status");
    const bool ascii = stored.settings.protocol == Protocol::Ascii;
    for (const std::string& part :
         {"address=" + sim::hex_byte_text(stored.settings.address),
          "baud=" + std::to_string(baud_rate(stored.settings.baud_code)), std::string("format=8N1"),
          std::string(ascii ? "protocol=ascii" : "protocol=modbus")}) {
      EXPECT_TRUE(has(status, part)) << stored.file << ": " << status;
    }
    EXPECT_TRUE(has(simulator.greeting(), "settings from " + directory / "image")) << stored.file;
    EXPECT_EQ(bytes_of_file(directory / "image"), image) << stored.file;
  }
}

TEST(Persistence, TheFileOverridesThePresetsAndTheGreetingReportsIt) {
  const Directory directory;
  Simulator({"EX9042D@0A,name=FILED" + image_in(directory)});
  const std::string image = bytes_of_file(directory / "image");
  Simulator simulator({"EX9042D@0B,name=TYPED,edge=rising" + image_in(directory)});
  EXPECT_EQ(simulator.ask("$0AM"), "!0AFILED");
  EXPECT_EQ(simulator.ask("$0A2"), "!0A400600");
  EXPECT_TRUE(has(simulator.greeting(), "EX9042D at 0A")) << simulator.greeting();
  EXPECT_TRUE(has(simulator.greeting(), directory / "image" + ", not those given here"))
      << simulator.greeting();
  EXPECT_EQ(bytes_of_file(directory / "image"), image);
}

TEST(Persistence, TheGreetingSaysThatTheFileOverridesTheBusFile) {
  const Directory directory;
  Simulator({"EX9042D@0A,name=FILED" + image_in(directory)});
  write_file(directory / "bus.json", R"({"lines": [{"port": "tcp:0", "modules": [
    {"model": "EX9042D", "address": "0B", "eeprom": "image"}]}]})");
  const Finished finished = run({simulator_path(), "bus.json", "--log", "--for", "100ms"}, directory.path());
  EXPECT_EQ(finished.status, 0) << finished.error;
  EXPECT_TRUE(has(finished.output, "settings from image, not those given here")) << finished.output;
}

TEST(Persistence, TheGreetingMentionsNoOverrideIfNoPresetDiffers) {
  const Directory directory;
  Simulator({"EX9042D@0A,name=FILED" + image_in(directory)});
  for (const char* module : {"EX9042D", "EX9042D@0A,name=FILED"}) {
    Simulator simulator({module + image_in(directory)});
    EXPECT_TRUE(has(simulator.greeting(), directory / "image")) << simulator.greeting();
    EXPECT_FALSE(has(simulator.greeting(), "not from the command line")) << simulator.greeting();
  }
}

TEST(Persistence, TheInitSwitchIsNotStored) {
  const Directory directory;
  Simulator({"EX9042D@0A,init=on" + image_in(directory)});
  Simulator simulator({"EX9042D" + image_in(directory)});
  EXPECT_TRUE(has(simulator.tell("1 status"), "address=0A")) << simulator.tell("1 status");
  EXPECT_TRUE(has(simulator.tell("1 status"), "mode=normal"));
}

TEST(Persistence, ModulesWithFilesKeepTheirNamesAndAModuleWithoutAFileDoesNot) {
  const Directory directory;
  const std::string first = "EX9042D@01,eeprom=" + directory / "first";
  const std::string second = "EX9052D@02,eeprom=" + directory / "second";
  {
    Simulator simulator({first, second, "EX9060D@03"});
    EXPECT_EQ(simulator.ask("~01OONE"), "!01");
    EXPECT_EQ(simulator.ask("~02OTWO"), "!02");
    EXPECT_EQ(simulator.ask("~03OTHREE"), "!03");
    simulator.process().end(SIGKILL);
  }
  Simulator simulator({"EX9060D@03", second, first});
  EXPECT_EQ(simulator.ask("$01M"), "!01ONE");
  EXPECT_EQ(simulator.ask("$02M"), "!02TWO");
  EXPECT_EQ(simulator.ask("$03M"), "!039060");
}

TEST(Persistence, AFileMayBeReachedThroughASymbolicLink) {
  const Directory directory;
  Simulator({"EX9042D" + image_in(directory)});
  fs::create_symlink("image", directory / "link");
  {
    Simulator simulator({"EX9042D,eeprom=" + directory / "link"});
    EXPECT_EQ(simulator.ask("~01ONEW"), "!01");
  }
  EXPECT_TRUE(fs::is_symlink(directory / "link"));
  EXPECT_EQ(Simulator({"EX9042D" + image_in(directory)}).ask("$01M"), "!01NEW");
}

// --- images without valid settings (wire.md D8) ---

/// Expects factory settings, a flashing LED, a greeting that mentions factory settings, and an unchanged
/// file. Then stores a name, and expects that the LED is on. After a restart, expects the name, and a
/// greeting that does not mention factory settings.
void expect_factory_settings(const Directory& directory) {
  const std::string image = bytes_of_file(directory / "image");
  {
    Simulator simulator({"EX9042D@0B,name=TYPED" + image_in(directory)});
    EXPECT_EQ(simulator.ask("$01M"), "!019042D");
    EXPECT_EQ(simulator.ask("$012"), "!01400600");
    EXPECT_EQ(simulator.tell("1 outputs"), "0000");
    EXPECT_EQ(simulator.tell("1 led"), "flashing");
    EXPECT_TRUE(has(simulator.greeting(), directory / "image")) << simulator.greeting();
    EXPECT_TRUE(has(simulator.greeting(), "factory settings")) << simulator.greeting();
    simulator.process().end(SIGKILL);
    EXPECT_EQ(bytes_of_file(directory / "image"), image);
  }
  {
    Simulator simulator({"EX9042D" + image_in(directory)});
    EXPECT_EQ(simulator.ask("~01ONEW"), "!01");
    EXPECT_EQ(simulator.tell("1 led"), "on");
    simulator.process().end(SIGKILL);
  }
  Simulator simulator({"EX9042D" + image_in(directory)});
  EXPECT_EQ(simulator.ask("$01M"), "!01NEW");
  EXPECT_EQ(simulator.tell("1 led"), "on");
  EXPECT_FALSE(has(simulator.greeting(), "factory settings")) << simulator.greeting();
}

TEST(Persistence, AnImageOfAnotherModelGivesFactorySettings) {
  const Directory directory;
  {
    Simulator other({"EX9043D" + image_in(directory)});
    EXPECT_EQ(other.ask("@01FFFF"), ">");
    EXPECT_EQ(other.ask("~015P"), "!01");
    EXPECT_EQ(other.ask("~01OOTHER"), "!01");
  }
  expect_factory_settings(directory);
}

TEST(Persistence, AnImageOfGarbageGivesFactorySettings) {
  std::mt19937 random(9042);
  std::string noise(kImageSize, '\0');
  std::generate(noise.begin(), noise.end(), [&random] { return static_cast<char>(random() & 0xFFU); });
  for (const std::string& image : {noise, std::string(kImageSize, '\0')}) {
    const Directory directory;
    write_file(directory / "image", image);
    expect_factory_settings(directory);
  }
}

TEST(Persistence, ABlankImageGivesFactorySettingsDespitePresetsAndTheGreetingReportsIt) {
  const Directory directory;
  write_file(directory / "image", std::string(kImageSize, '\xFF'));
  {
    Simulator simulator({"EX9042D@0B,name=TYPED" + image_in(directory)});
    EXPECT_EQ(simulator.ask("$01M"), "!019042D");
    EXPECT_EQ(simulator.tell("1 led"), "on");
    EXPECT_TRUE(has(simulator.greeting(),
                    directory / "image" + " is blank: factory settings, not those given here\n"))
        << simulator.greeting();
    EXPECT_FALSE(has(simulator.greeting(), "settings from")) << simulator.greeting();
    EXPECT_EQ(simulator.ask("~01OPUMP"), "!01");
  }
  Simulator simulator({"EX9042D" + image_in(directory)});
  EXPECT_TRUE(has(simulator.greeting(), "; settings from " + directory / "image\n")) << simulator.greeting();
}

}  // namespace
}  // namespace ex9000::system
