// Tests the syntax MODEL[@ADDR][,KEY=VALUE]... on the simulator's command line.
#include "sim/notation/module_notation.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/support/refusal.hpp"

namespace ex9000::sim {
namespace {

/// Returns the error message for an argument.
std::string error_of(const std::string& text) {
  return refusal([&] { parse_module_spec(text); });
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

// The tests of bus files and transcripts choose the protocol, the checksum, the edge and the baud rate.
TEST(ModuleSpec, EveryLineFormatCanBeCombinedWithARateInAnyOrder) {
  const std::vector<std::pair<std::string, unsigned>> formats{
      {"8N1", 0x00}, {"8N2", 0x40}, {"8E1", 0x80}, {"8O1", 0xC0}};
  for (const auto& [format, bits] : formats) {
    EXPECT_EQ(parse_module_spec("EX9042D,format=" + format).settings.baud_code, bits | 0x06U);
    EXPECT_EQ(parse_module_spec("EX9042D,baud=115200,format=" + format).settings.baud_code, bits | 0x0AU);
    EXPECT_EQ(parse_module_spec("EX9042D,format=" + format + ",baud=1200").settings.baud_code, bits | 0x03U);
  }
}

TEST(ModuleSpec, KeysCanBeCombined) {
  const ModuleSpec spec =
      parse_module_spec("9052d-m@1F,protocol=ascii,baud=19200,checksum=on,edge=rising,name=a=b@c,init=on");
  EXPECT_EQ(spec.model->designation, "EX9052D-M");
  EXPECT_EQ(spec.settings.address, 0x1F);
  EXPECT_EQ(baud_rate(spec.settings.baud_code), 19200U);
  EXPECT_EQ(spec.settings.format, 0xC0);
  EXPECT_EQ(spec.settings.name, Name("a=b@c"));
  EXPECT_TRUE(spec.init_asserted);
}

TEST(ModuleSpec, TheEepromFileAndInitAreNotSettings) {
  const ModuleSpec spec = parse_module_spec("EX9042D-M,eeprom=a dir/pump.bin,init=off");
  EXPECT_EQ(spec.eeprom, "a dir/pump.bin");
  EXPECT_FALSE(spec.settings_given);
  EXPECT_TRUE(parse_module_spec("EX9042D-M@01").settings_given);
  EXPECT_TRUE(parse_module_spec("EX9042D-M,baud=9600").settings_given);
}

TEST(ModuleSpec, AWrongArgumentIsRefusedWithWhatWouldBeRight) {
  EXPECT_EQ(parse_module_spec("EX9042D-M@F7").settings.address, 0xF7);
  EXPECT_EQ(parse_module_spec("EX9042D-M@F8,protocol=ascii").settings.address, 0xF8);
  for (const auto& [text, mend] : std::vector<std::pair<const char*, const char*>>{
           {"X9042D", "--models"},
           {"EX9042D-M ", "--models"},
           {"@01", "--models"},
           {",baud=9600", "--models"},
           {"EX9042D@", "one or two hex digits"},
           {"EX9042D@001", "one or two hex digits"},
           {"EX9042D@0x1", "one or two hex digits"},
           {"EX9042D-M@00", "01 to F7"},
           {"EX9042D-M@F8", "01 to F7"},
           {"EX9042D-M,protocol=rtu", "modbus or ascii"},
           {"EX9042D-M,protocol", "modbus or ascii"},
           {"EX9042D-M,checksum=yes", "on or off"},
           {"EX9042D-M,edge=both", "rising or falling"},
           {"EX9042D-M,init=1", "on or off"},
           {"EX9042D-M,format=7E1", "format=: '7E1': expected a line format: 8N1, 8N2, 8E1 or 8O1"},
           {"EX9042D-M,baud=300", "1200, 2400, 4800, 9600, 19200, 38400, 57600 or 115200"},
           {"EX9042D-M,baud=", "9600"},
           {"EX9042D,protocol=modbus", "'modbus': the EX9042D speaks ASCII only; expected ascii"},
           {"EX9042D,name=", "1 to 6"},
           {"EX9042D,name=ABCDEFG", "1 to 6"},
           {"EX9068D-M,name=ABCDEFGH", "1 to 7 printable ASCII characters for the EX9068D-M"},
           {"EX9042D,name=a\x7F", "printable"},
           {"EX9042D,name=\xC3\xBC", "printable"},
           {"EX9042D,,baud=9600", "nothing follows a comma; leave the comma out, or add KEY=VALUE"},
           {"EX9042D,baud=9600,", "nothing follows a comma; leave the comma out, or add KEY=VALUE"},
           {"EX9052D,edge=rising,edge=rising", "is given twice"},
           {"EX9042D,Baud=9600", "=: unknown key; expected one of address, protocol, baud, format"},
       }) {
    const std::string error = error_of(text);
    EXPECT_EQ(error.find(std::string(text) + ": "), 0U) << error;
    EXPECT_NE(error.find(mend), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace ex9000::sim
