// Tests the factory settings, names, the settings that are possible for a model, changes of settings, and
// comparisons (wire.md sections 1, 2, 4, 7 and 8, and firmware/extensions.md).
#include "firmware/settings/settings.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/oracles/reference/models.hpp"

namespace ex9000 {
namespace {

const Model& model(std::string_view designation) { return *find_model(designation); }

std::string text_of(const Name& name) { return {name.bytes().begin(), name.bytes().end()}; }

// --- factory ---

TEST(FactorySettings, AreThoseOfSection2OnEveryModel) {
  for (const Model& each : kModels) {
    const Settings factory = Settings::factory(each);
    EXPECT_EQ(factory.address, 0x01) << each.designation;
    EXPECT_EQ(factory.baud_code, 0x06) << each.designation;
    EXPECT_EQ(factory.format, 0x00) << each.designation;
    EXPECT_EQ(factory.power_on_value, 0) << each.designation;
    EXPECT_EQ(factory.safe_value, 0) << each.designation;
    EXPECT_FALSE(factory.watchdog_enabled) << each.designation;
    EXPECT_EQ(factory.watchdog_timeout, 0xFF) << each.designation;
    EXPECT_FALSE(factory.timeout_status) << each.designation;
  }
}

TEST(FactorySettings, AnMModelUsesModbusAndOtherModelsUseAscii) {
  for (const Model& each : kModels) {
    const bool is_m = each.designation.substr(each.designation.size() - 2) == "-M";
    EXPECT_EQ(Settings::factory(each).protocol, is_m ? Protocol::ModbusRtu : Protocol::Ascii)
        << each.designation;
  }
}

TEST(FactorySettings, HaveTheNameOfSection1) {
  for (const reference::ModelRow& row : reference::kModelRows) {
    EXPECT_EQ(text_of(Settings::factory(model(row.designation)).name), row.name) << row.designation;
  }
}

TEST(FactorySettings, ArePossibleOnTheirModel) {
  for (const Model& each : kModels) {
    EXPECT_TRUE(Settings::factory(each).possible_for(each)) << each.designation;
  }
}

// --- names ---

TEST(Name, HoldsUpTo7Characters) {
  EXPECT_EQ(text_of(Name("9068D-M")), "9068D-M");
  EXPECT_EQ(text_of(Name("x")), "x");
  EXPECT_EQ(text_of(Name()), "");
}

TEST(Name, KeepsTheFirst7CharactersOfALongerText) { EXPECT_EQ(text_of(Name("9068AD-M")), "9068AD-"); }

TEST(Name, EqualsOnlyANameWithTheSameCharacters) {
  EXPECT_TRUE(Name("9042D") == Name("9042D"));
  EXPECT_FALSE(Name("9042D") == Name("9042d"));
  EXPECT_FALSE(Name("9042") == Name("9042D"));
  EXPECT_FALSE(Name("9042") == Name("9042 "));
}

TEST(Name, NameCharactersAreThoseFrom20To7E) {
  for (unsigned character = 0; character < 256; ++character) {
    EXPECT_EQ(Name::is_name_character(static_cast<std::uint8_t>(character)),
              character >= 0x20 && character <= 0x7E);
  }
}

// --- possible_for ---

class Possible : public testing::Test {
 protected:
  [[nodiscard]] bool possible() const { return settings_.possible_for(model_); }
  void use(std::string_view designation) {
    model_ = model(designation);
    settings_ = Settings::factory(model_);
  }
  Model model_ = model("EX9042D-M");
  Settings settings_ = Settings::factory(model_);
};

TEST_F(Possible, AsciiAllowsEveryAddress) {
  settings_.protocol = Protocol::Ascii;
  for (unsigned address = 0; address < 256; ++address) {
    settings_.address = static_cast<std::uint8_t>(address);
    EXPECT_TRUE(possible()) << address;
  }
}

TEST_F(Possible, ModbusAllowsAddresses1To247) {
  for (unsigned address = 0; address < 256; ++address) {
    settings_.address = static_cast<std::uint8_t>(address);
    EXPECT_EQ(possible(), address >= 1 && address <= 247) << address;
  }
}

TEST_F(Possible, OnlyMModelsAllowModbus) {
  for (const Model& each : kModels) {
    Settings settings = Settings::factory(each);
    settings.protocol = Protocol::ModbusRtu;
    EXPECT_EQ(settings.possible_for(each), each.designation.substr(each.designation.size() - 2) == "-M");
    settings.protocol = Protocol::Ascii;
    EXPECT_TRUE(settings.possible_for(each));
  }
}

TEST_F(Possible, TheLowSixBitsOfABaudCodeAre03To0A) {
  for (unsigned code = 0; code < 256; ++code) {
    settings_.baud_code = static_cast<std::uint8_t>(code);
    EXPECT_EQ(possible(), (code & 0x3F) >= 0x03 && (code & 0x3F) <= 0x0A) << code;
  }
}

TEST_F(Possible, AFormatHasOnlyBits7And6) {
  for (unsigned format = 0; format < 256; ++format) {
    settings_.format = static_cast<std::uint8_t>(format);
    EXPECT_EQ(possible(), (format & 0x3FU) == 0) << format;
  }
}

TEST_F(Possible, OutputValuesHaveOnlyTheModelsChannels) {
  const std::vector<std::pair<std::string_view, unsigned>> outputs{
      {"EX9042D", 13}, {"EX9043D", 16}, {"EX9052D", 0}, {"EX9068D-M", 8}, {"EX9060D", 4}, {"EX9063D", 3}};
  for (const auto& [designation, channels] : outputs) {
    use(designation);
    for (unsigned bit = 0; bit < 16; ++bit) {
      settings_.power_on_value = static_cast<std::uint16_t>(1U << bit);
      settings_.safe_value = 0;
      EXPECT_EQ(possible(), bit < channels) << designation << " power-on bit " << bit;
      settings_.safe_value = settings_.power_on_value;
      settings_.power_on_value = 0;
      EXPECT_EQ(possible(), bit < channels) << designation << " safe bit " << bit;
    }
  }
}

TEST_F(Possible, ANameOfAnEX9042DMHas1To6Characters) {
  settings_.name = Name();
  EXPECT_FALSE(possible());
  settings_.name = Name("A");
  EXPECT_TRUE(possible());
  settings_.name = Name("ABCDEF");
  EXPECT_TRUE(possible());
  settings_.name = Name("ABCDEFG");
  EXPECT_FALSE(possible());
}

TEST_F(Possible, ANameOf7CharactersIsPossibleOnTheTwoEX9068MModels) {
  for (const char* designation : {"EX9068D-M", "EX9068AD-M"}) {
    use(designation);
    settings_.name = Name("ABCDEFG");
    EXPECT_TRUE(possible());
  }
  use("EX9068D");
  settings_.name = Name("ABCDEFG");
  EXPECT_FALSE(possible());
}

TEST_F(Possible, ANameHasOnlyPrintableCharacters) {
  settings_.name = Name(" ~$01m");
  EXPECT_TRUE(possible());
  for (const char* name : {"\x1F", "A\x7F", "AB\r", "\xFF"}) {
    settings_.name = Name(name);
    EXPECT_FALSE(possible()) << name;
  }
}

TEST_F(Possible, ATimeoutOf0RequiresADisabledWatchdog) {
  settings_.watchdog_timeout = 0;
  EXPECT_TRUE(possible());
  settings_.watchdog_enabled = true;
  EXPECT_FALSE(possible());
  settings_.watchdog_timeout = 1;
  EXPECT_TRUE(possible());
}

TEST_F(Possible, TheTimeoutStatusIsPossibleWithAnEnabledAndADisabledWatchdog) {
  settings_.timeout_status = true;
  EXPECT_TRUE(possible());
  settings_.watchdog_enabled = true;
  EXPECT_TRUE(possible());
}

// --- changes ---

/// Calls the function `name` with an empty change. Returns the change with the values that `name` has set.
template <class Naming>
SettingsChange change(Naming name) {
  SettingsChange change;
  name(change);
  return change;
}

struct FieldChange {
  const char* field;
  SettingsChange change;
  Settings expected;
};

/// Returns one change for each field, except for the fields of the extensions. `from` must be the factory
/// settings of an EX9042D-M, so that each change sets a value that `from` does not have.
std::vector<FieldChange> changes_of_each_field(const Settings& from) {
  std::vector<FieldChange> changes;
  const auto add = [&](const char* field, auto name, auto mutate) {
    Settings expected = from;
    mutate(expected);
    changes.push_back({field, change(name), expected});
  };
  using Change = SettingsChange;
  add(
      "address", [](Change& c) { c.address = 0x2A; }, [](Settings& s) { s.address = 0x2A; });
  add(
      "baud code", [](Change& c) { c.baud_code = 0x0A; }, [](Settings& s) { s.baud_code = 0x0A; });
  add(
      "format", [](Change& c) { c.format = 0xC0; }, [](Settings& s) { s.format = 0xC0; });
  add(
      "protocol", [](Change& c) { c.protocol = Protocol::Ascii; },
      [](Settings& s) { s.protocol = Protocol::Ascii; });
  add(
      "name", [](Change& c) { c.name = Name("pump"); }, [](Settings& s) { s.name = Name("pump"); });
  add(
      "power-on value", [](Change& c) { c.power_on_value = 0x1234; },
      [](Settings& s) { s.power_on_value = 0x1234; });
  add(
      "safe value", [](Change& c) { c.safe_value = 0x0F0F; }, [](Settings& s) { s.safe_value = 0x0F0F; });
  add(
      "watchdog enable", [](Change& c) { c.watchdog_enabled = true; },
      [](Settings& s) { s.watchdog_enabled = true; });
  add(
      "timeout", [](Change& c) { c.watchdog_timeout = 0x64; },
      [](Settings& s) { s.watchdog_timeout = 0x64; });
  add(
      "timeout status", [](Change& c) { c.timeout_status = true; },
      [](Settings& s) { s.timeout_status = true; });
  return changes;
}

TEST(SettingsChange, AChangeWithoutValuesChangesNothing) {
  for (const Model& each : kModels) {
    EXPECT_TRUE(SettingsChange().applied_to(Settings::factory(each)) == Settings::factory(each));
  }
}

TEST(SettingsChange, AChangeOfOneFieldChangesThatFieldAlone) {
  const Settings factory = Settings::factory(model("EX9042D-M"));
  for (const FieldChange& each : changes_of_each_field(factory)) {
    EXPECT_TRUE(each.change.applied_to(factory) == each.expected) << each.field;
  }
}

TEST(SettingsChange, AChangeOfOneFieldMakesTheSettingsUnequal) {
  const Settings factory = Settings::factory(model("EX9042D-M"));
  for (const FieldChange& each : changes_of_each_field(factory)) {
    EXPECT_TRUE(each.change.applied_to(factory) != factory) << each.field;
  }
}

TEST(SettingsChange, AChangeOfOneFieldKeepsEarlierChangesOfOtherFields) {
  const Settings factory = Settings::factory(model("EX9042D-M"));
  Settings all = factory;
  for (const FieldChange& each : changes_of_each_field(factory)) {
    all = each.change.applied_to(all);
  }
  EXPECT_EQ(all.address, 0x2A);
  EXPECT_EQ(all.baud_code, 0x0A);
  EXPECT_EQ(all.format, 0xC0);
  EXPECT_EQ(all.protocol, Protocol::Ascii);
  EXPECT_EQ(text_of(all.name), "pump");
  EXPECT_EQ(all.power_on_value, 0x1234);
  EXPECT_EQ(all.safe_value, 0x0F0F);
  EXPECT_TRUE(all.watchdog_enabled);
  EXPECT_EQ(all.watchdog_timeout, 0x64);
  EXPECT_TRUE(all.timeout_status);
}

TEST(SettingsChange, AChangeOfSeveralFieldsChangesThemTogether) {
  const Settings factory = Settings::factory(model("EX9042D-M"));
  const Settings changed = change([](SettingsChange& c) {
                             c.address = 7;
                             c.baud_code = 3;
                           }).applied_to(factory);
  Settings expected = factory;
  expected.address = 7;
  expected.baud_code = 3;
  EXPECT_TRUE(changed == expected);
}

TEST(SettingsChange, TheLastValueOfAFieldApplies) {
  const Settings factory = Settings::factory(model("EX9042D-M"));
  const SettingsChange twice = change([](SettingsChange& c) {
    c.address = 7;
    c.address = 8;
  });
  EXPECT_EQ(twice.applied_to(factory).address, 8);
}

TEST(SettingsChange, AShorterNameReplacesALongerOneCompletely) {
  Settings settings = Settings::factory(model("EX9068D-M"));
  settings.name = Name("ABCDEFG");
  Settings expected = settings;
  expected.name = Name("x");
  EXPECT_TRUE(change([](SettingsChange& c) { c.name = Name("x"); }).applied_to(settings) == expected);
  const SettingsChange twice = change([](SettingsChange& c) {
    c.name = Name("QRSTUVW");
    c.name = Name("x");
  });
  EXPECT_TRUE(twice.applied_to(settings) == expected);
}

TEST(SettingsChange, AChangeCanGiveAFieldTheValueFalseOr0) {
  Settings settings = Settings::factory(model("EX9042D-M"));
  settings.watchdog_enabled = settings.timeout_status = true;
  settings.safe_value = 0x1FFF;
  const Settings changed = change([](SettingsChange& c) {
                             c.watchdog_enabled = false;
                             c.timeout_status = false;
                             c.safe_value = 0;
                           }).applied_to(settings);
  EXPECT_FALSE(changed.watchdog_enabled);
  EXPECT_FALSE(changed.timeout_status);
  EXPECT_EQ(changed.safe_value, 0);
}

TEST(SettingsChange, AClearedChangeChangesNothing) {
  const Settings factory = Settings::factory(model("EX9042D-M"));
  for (FieldChange& each : changes_of_each_field(factory)) {
    each.change = SettingsChange();
    EXPECT_TRUE(each.change.applied_to(factory) == factory) << each.field;
  }
}

// A module uses the same change object for all requests.
TEST(SettingsChange, AClearedChangeChangesOnlyWhatIsSetAfterwards) {
  const Settings factory = Settings::factory(model("EX9042D-M"));
  SettingsChange reused;
  for (const FieldChange& each : changes_of_each_field(factory)) {
    reused = each.change;
    reused = SettingsChange();
    reused.watchdog_timeout = 0x64;
    Settings expected = factory;
    expected.watchdog_timeout = 0x64;
    EXPECT_TRUE(reused.applied_to(factory) == expected) << each.field;
  }
}

// --- comparison ---

TEST(Settings, AreUnequalIfDifferentFieldsWereChanged) {
  const Settings factory = Settings::factory(model("EX9042D-M"));
  const std::vector<FieldChange> changes = changes_of_each_field(factory);
  for (const FieldChange& one : changes) {
    for (const FieldChange& other : changes) {
      EXPECT_EQ(one.expected == other.expected, &one == &other) << one.field << " and " << other.field;
    }
  }
}

// --- extensions: firmware/extensions.md ---

TEST_F(Possible, AFilterTimeIsAtMost2000MsAndOnlyForAnInputOfTheModel) {
  use("EX9052D");
  for (const unsigned channel : {0U, 7U}) {
    settings_.input_filters.set(channel, 2000);
    EXPECT_TRUE(possible()) << channel;
    settings_.input_filters.set(channel, 2001);
    EXPECT_FALSE(possible()) << channel;
    settings_.input_filters.set(channel, 0);
  }
  settings_.input_filters.set(8, 1);
  EXPECT_FALSE(possible());
}

TEST_F(Possible, OnlyInputsOfTheModelCanBeInverted) {
  use("EX9052D");
  settings_.inverted_inputs = 0x00FF;
  EXPECT_TRUE(possible());
  settings_.inverted_inputs = 0x0100;
  EXPECT_FALSE(possible());
}

TEST_F(Possible, TheResponseDelayIsAtMost30Ms) {
  settings_.response_delay = 30;
  EXPECT_TRUE(possible());
  settings_.response_delay = 31;
  EXPECT_FALSE(possible());
}

TEST_F(Possible, ASerialNumberIs0D00AndAnyWordOrZeroForThatOfTheBoard) {
  for (const std::uint32_t number : {0U, 0x0D000000U, 0x0D00FFFFU}) {
    settings_.serial_number = number;
    EXPECT_TRUE(possible()) << number;
  }
  for (const std::uint32_t number : {1U, 0x0CFFFFFFU, 0x0D010000U, 0xFFFF0000U, 0xFFFFFFFFU}) {
    settings_.serial_number = number;
    EXPECT_FALSE(possible()) << number;
  }
}

}  // namespace
}  // namespace ex9000
