// Tests the syntax MODEL[@ADDR][,KEY=VALUE]... on the simulator's command line.
#include "sim/notation/module_notation.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace ex9000::sim {
namespace {

std::string name_of(const ModuleSpec& spec) {
  const Bytes name = spec.settings.name.bytes();
  return {name.begin(), name.end()};
}

/// Returns the error message for an argument, or an empty text if the argument is valid.
std::string error_of(const std::string& text) {
  try {
    parse_module_spec(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/// Expects a one-line error message that begins with the argument and contains `mend`, which says what would
/// be right.
void expect_error(const std::string& text, const std::string& mend) {
  const std::string error = error_of(text);
  EXPECT_EQ(error.find(text + ": "), 0U) << text << " -> " << error;
  EXPECT_NE(error.find(mend), std::string::npos) << text << " -> " << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

TEST(ModuleSpec, AModelAloneHasItsFactorySettings) {
  for (const Model& model : kModels) {
    const ModuleSpec spec = parse_module_spec(std::string(model.designation));
    EXPECT_EQ(spec.model->designation, model.designation);
    EXPECT_TRUE(spec.settings == Settings::factory(model));
    EXPECT_FALSE(spec.init_asserted);
    EXPECT_EQ(spec.settings.address, 0x01);
    EXPECT_FALSE(spec.settings_given);
    EXPECT_EQ(spec.eeprom, "");
    EXPECT_EQ(baud_rate(spec.settings.baud_code), 9600U);
  }
}

TEST(ModuleSpec, AModelCanBeInLowerCaseAndWithoutEX) {
  for (const char* text : {"EX9042D-M", "ex9042d-m", "9042D-M", "9042d-m", "Ex9042D-m"}) {
    EXPECT_EQ(parse_module_spec(text).model->designation, "EX9042D-M") << text;
  }
  EXPECT_EQ(parse_module_spec("9042d").model->designation, "EX9042D");
}

TEST(ModuleSpec, AMistypedModelGetsTheNearestNames) {
  const std::string all = "; 'ex9000-sim --models' lists all models";
  for (const auto& [name, nearest] : std::vector<std::pair<std::string, std::string>>{
           {"EX9055D-M", "; nearest: EX9055D"},  // one character from EX9052D-M, but the number tells more
           {"9042", "; nearest: EX9042D, EX9042D-M"},
           {"ex9042m", "; nearest: EX9042D, EX9042D-M"},
           {"9066d-m", "; nearest: EX9066D"},
           {"EX905D", "; nearest: EX9052D, EX9050D, EX9053D, EX9055D, EX9065D"},
           {"EY9060D", "; nearest: EX9060D, EX9060D-M"},
           {"EX8100D", ""},
           {"EX1", ""},
           {"pump", ""},
           {std::string(10'000, '9'), ""}}) {
    EXPECT_EQ(error_of(name), name + ": '" + name + "' is not a model" + nearest + all);
  }
}

TEST(ModuleSpec, TheAddressIsHex) {
  EXPECT_EQ(parse_module_spec("EX9042D@0A").settings.address, 0x0A);
  EXPECT_EQ(parse_module_spec("EX9042D@0a").settings.address, 0x0A);
  EXPECT_EQ(parse_module_spec("EX9042D@A").settings.address, 0x0A);
  EXPECT_EQ(parse_module_spec("EX9042D@10").settings.address, 0x10);
  EXPECT_EQ(parse_module_spec("EX9042D@FF").settings.address, 0xFF);
  EXPECT_EQ(parse_module_spec("EX9042D@00").settings.address, 0x00);
}

TEST(ModuleSpec, AModbusAddressIs01ToF7) {
  EXPECT_EQ(parse_module_spec("EX9042D-M@F7").settings.address, 0xF7);
  expect_error("EX9042D-M@00", "01 to F7");
  expect_error("EX9042D-M@F8", "01 to F7");
  EXPECT_EQ(parse_module_spec("EX9042D-M@F8,protocol=ascii").settings.address, 0xF8);
}

TEST(ModuleSpec, TheProtocolCanBeChosen) {
  const ModuleSpec ascii = parse_module_spec("EX9042D-M,protocol=ascii");
  EXPECT_EQ(ascii.settings.protocol, Protocol::Ascii);
  const ModuleSpec modbus = parse_module_spec("EX9042D-M,protocol=modbus");
  EXPECT_EQ(modbus.settings.protocol, Protocol::ModbusRtu);
}

TEST(ModuleSpec, EveryBaudRateOfAModuleCanBeChosen) {
  const unsigned rates[] = {1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200};
  std::uint8_t code = 0x03;
  for (const unsigned rate : rates) {
    const ModuleSpec spec = parse_module_spec("EX9042D,baud=" + std::to_string(rate));
    EXPECT_EQ(spec.settings.baud_code, code++) << rate;
    EXPECT_EQ(baud_rate(spec.settings.baud_code), rate);
  }
}

TEST(ModuleSpec, EveryLineFormatCanBeCombinedWithARateInAnyOrder) {
  const std::vector<std::pair<std::string, unsigned>> formats{
      {"8N1", 0x00}, {"8N2", 0x40}, {"8E1", 0x80}, {"8O1", 0xC0}};
  for (const auto& [format, bits] : formats) {
    EXPECT_EQ(parse_module_spec("EX9042D,format=" + format).settings.baud_code, bits | 0x06U);
    EXPECT_EQ(parse_module_spec("EX9042D,baud=115200,format=" + format).settings.baud_code, bits | 0x0AU);
    EXPECT_EQ(parse_module_spec("EX9042D,format=" + format + ",baud=1200").settings.baud_code, bits | 0x03U);
  }
}

TEST(ModuleSpec, TheKeysChecksumAndEdgeEachSelectABitOfTheDataFormat) {
  EXPECT_EQ(parse_module_spec("EX9052D,checksum=on").settings.format, 0x40);
  EXPECT_EQ(parse_module_spec("EX9052D,checksum=off").settings.format, 0x00);
  EXPECT_EQ(parse_module_spec("EX9052D,edge=rising").settings.format, 0x80);
  EXPECT_EQ(parse_module_spec("EX9052D,edge=falling").settings.format, 0x00);
  EXPECT_EQ(parse_module_spec("EX9052D,checksum=on,edge=rising").settings.format, 0xC0);
}

TEST(ModuleSpec, AKeyGivenTwiceIsRefused) {
  EXPECT_THROW(parse_module_spec("EX9052D,checksum=on,edge=rising,checksum=off"), std::invalid_argument);
}

TEST(ModuleSpec, TheNameIsStoredUnchanged) {
  EXPECT_EQ(name_of(parse_module_spec("EX9042D,name=pump 1")), "pump 1");
  EXPECT_EQ(name_of(parse_module_spec("EX9042D,name=a=b@c")), "a=b@c");
  EXPECT_EQ(name_of(parse_module_spec("EX9068D-M,name=ABCDEFG")), "ABCDEFG");
}

TEST(ModuleSpec, InitDoesNotChangeTheStoredSettings) {
  const ModuleSpec spec = parse_module_spec("EX9042D-M@2A,baud=115200,init=on");
  EXPECT_TRUE(spec.init_asserted);
  EXPECT_EQ(spec.settings.address, 0x2A);
  EXPECT_EQ(spec.settings.baud_code, 0x0A);
  EXPECT_FALSE(parse_module_spec("EX9042D-M,init=off").init_asserted);
}

TEST(ModuleSpec, TheEepromFileAndInitAreNotSettings) {
  const ModuleSpec spec = parse_module_spec("EX9042D-M,eeprom=a dir/pump.bin,init=off");
  EXPECT_EQ(spec.eeprom, "a dir/pump.bin");
  EXPECT_FALSE(spec.settings_given);
  EXPECT_TRUE(parse_module_spec("EX9042D-M@01").settings_given);
  EXPECT_TRUE(parse_module_spec("EX9042D-M,baud=9600").settings_given);
}

TEST(ModuleSpec, KeysCanBeCombined) {
  const ModuleSpec spec =
      parse_module_spec("9052d-m@1F,protocol=ascii,baud=19200,checksum=on,edge=rising,name=x");
  EXPECT_EQ(spec.model->designation, "EX9052D-M");
  EXPECT_EQ(spec.settings.address, 0x1F);
  EXPECT_EQ(baud_rate(spec.settings.baud_code), 19200U);
  EXPECT_EQ(spec.settings.format, 0xC0);
  EXPECT_EQ(name_of(spec), "x");
}

TEST(ModuleSpec, AcceptedSettingsCanBeStoredByTheModel) {
  for (const char* text : {"EX9042D@00", "EX9042D-M@F7,name=~", "EX9068AD-M,name=ABCDEFG,checksum=on"}) {
    const ModuleSpec spec = parse_module_spec(text);
    EXPECT_TRUE(spec.settings.possible_for(*spec.model)) << text;
  }
}

TEST(ModuleSpec, AnUnknownModelIsRefused) {
  for (const char* text : {"EX9999", "EX", "X9042D", "EX9042D-M ", "EX9042", "@01", ",baud=9600"}) {
    expect_error(text, "--models");
  }
}

TEST(ModuleSpec, TheMessageAboutAnEmptyArgumentIsOneLine) {
  const std::string error = error_of("");
  EXPECT_NE(error.find("empty argument"), std::string::npos) << error;
  EXPECT_NE(error.find("--models"), std::string::npos) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos);
}

TEST(ModuleSpec, AnAddressThatIsNotOneOrTwoHexDigitsIsRefused) {
  for (const char* text :
       {"EX9042D@", "EX9042D@G1", "EX9042D@001", "EX9042D@-1", "EX9042D@0x1", "EX9042D@ 1"}) {
    expect_error(text, "one or two hex digits");
  }
}

TEST(ModuleSpec, TheMessageAboutAWrongValueListsTheAllowedValues) {
  expect_error("EX9042D-M,protocol=rtu", "modbus or ascii");
  expect_error("EX9042D-M,protocol=", "modbus or ascii");
  expect_error("EX9042D-M,protocol", "modbus or ascii");
  expect_error("EX9042D-M,checksum=yes", "on or off");
  expect_error("EX9042D-M,edge=both", "rising or falling");
  expect_error("EX9042D-M,init=1", "on or off");
  expect_error("EX9042D-M,format=7E1", "format=: '7E1': expected a line format: 8N1, 8N2, 8E1 or 8O1");
  expect_error("EX9042D-M,format=", "8N1, 8N2, 8E1 or 8O1");
  expect_error("EX9042D-M,baud=300", "1200, 2400, 4800, 9600, 19200, 38400, 57600 or 115200");
  expect_error("EX9042D-M,baud=9600x", "9600");
  expect_error("EX9042D-M,baud=", "9600");
}

TEST(ModuleSpec, ModbusIsRefusedForAModelWithoutIt) {
  expect_error("EX9042D,protocol=modbus",
               "protocol=: 'modbus': the EX9042D speaks ASCII only; expected ascii");
}

TEST(ModuleSpec, ANameThatTheModelCannotStoreIsRefused) {
  expect_error("EX9042D,name=", "1 to 6");
  expect_error("EX9042D,name=ABCDEFG", "1 to 6");
  expect_error("EX9068D-M,name=ABCDEFGH", "1 to 7 printable ASCII characters for the EX9068D-M");
  expect_error("EX9042D,name=a\x7F", "printable");
  expect_error("EX9042D,name=\xC3\xBC", "printable");
}

TEST(ModuleSpec, ASurplusCommaIsRefused) {
  for (const char* text : {"EX9042D,,baud=9600", "EX9042D,", "EX9042D,baud=9600,"}) {
    expect_error(text, ": nothing follows a comma; leave the comma out, or add KEY=VALUE");
  }
}

TEST(ModuleSpec, TheMessageAboutAnUnknownKeyListsTheKnownKeys) {
  for (const char* text : {"EX9042D,adress=01", "EX9042D,Baud=9600", "EX9042D,x"}) {
    expect_error(text,
                 "=: unknown key; expected one of address, protocol, baud, format, checksum, edge, name, "
                 "init, eeprom");
  }
}

}  // namespace
}  // namespace ex9000::sim
