// Tests which models each format describes, and which arguments are rejected.
#include "sim/app/exports/describe.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "firmware/model/model.hpp"

namespace ex9000::sim {
namespace {

constexpr const char* kForAnyModel[] = {"csv", "json", "markdown"};
constexpr const char* kForTools[] = {"esphome", "home-assistant", "node-red", "wb-mqtt-serial"};

std::string described(const std::string& model, const char* format) {
  DescribeTexts texts;
  texts.model = model;
  texts.format = format;
  return describe(texts);
}

/// Expects that the arguments are rejected with a one-line message that contains `wrong` and `mend`.
void expect_refused(const DescribeTexts& texts, const std::string& wrong, const std::string& mend) {
  try {
    describe(texts);
    ADD_FAILURE() << texts.format << " is accepted for " << texts.model;
  } catch (const std::invalid_argument& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find(wrong), std::string::npos) << what;
    EXPECT_NE(what.find(mend), std::string::npos) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
  }
}

TEST(Describe, FormatsForAnyModelDescribeOneModelOrAll) {
  for (const char* format : kForAnyModel) {
    const std::string all = described("", format);
    for (const Model& model : kModels) {
      const std::string name(model.designation);
      EXPECT_NE(all.find(name), std::string::npos) << format << " of " << name;
      EXPECT_NE(described(name, format).find(name), std::string::npos) << format << " of " << name;
    }
    EXPECT_EQ(described("EX9042D", format).find("EX9055D"), std::string::npos);
  }
}

TEST(Describe, RegistersMdHasTheDescriptionOfAllModels) {
  std::ifstream file("firmware/registers.md");
  std::ostringstream text;
  text << file.rdbuf();
  const std::string generated = " describe -->\n" + described("", "markdown") + "<!-- end of ";
  EXPECT_NE(text.str().find(generated), std::string::npos) << "run toolchain/update-documents";
}

TEST(Describe, TheTemplateOfEachFormatCanBeFilledInForEachModelWithModbus) {
  std::istringstream formats(format_names());
  for (std::string format; std::getline(formats, format, '|');) {
    for (const Model& model : kModels) {
      if (model.speaks_modbus()) {
        const std::string text = described(std::string(model.designation), format.c_str());
        EXPECT_EQ(text.find("{{"), std::string::npos) << format;
        EXPECT_EQ(text.back(), '\n') << format;
      }
    }
  }
}

TEST(Describe, FormatsForToolsRequireAModelWithModbus) {
  for (const char* format : kForTools) {
    for (const Model& model : kModels) {
      const std::string name(model.designation);
      if (model.speaks_modbus()) {
        EXPECT_NE(described(name, format).find(name), std::string::npos) << format;
      } else {
        expect_refused({name, format, {}, {}},
                       name + " --format " + format + ": the model does not support Modbus", "--models");
      }
    }
    expect_refused({"", format, {}, {}}, std::string("--format ") + format, "MODEL");
    expect_refused({"EX1", format, {}, {}}, "'EX1'", "--models");
  }
}

TEST(Describe, AnAddressIsOneOrTwoHexDigitsFrom01ToF7) {
  for (const char* address : {"0", "00", "F8", "FF"}) {
    expect_refused({"EX9042D-M", "home-assistant", address, {}}, std::string("--address: '") + address,
                   "expected a Modbus address, hex 01 to F7");
  }
  for (const char* address : {"", "001", "1G", "0x1", "-1", "1,"}) {
    expect_refused({"EX9042D-M", "home-assistant", address, {}}, "--address: '" + std::string(address) + "'",
                   "expected one or two hex digits");
  }
  EXPECT_NE(describe({"EX9042D-M", "home-assistant", "f7", {}}).find("slave: 247\n"), std::string::npos);
  EXPECT_NE(describe({"EX9042D-M", "esphome", "a", {}}).find("address: 10\n"), std::string::npos);
}

TEST(Describe, AnInvalidTcpHostOrPortIsRefused) {
  for (const char* tcp : {"", "0", "localhost:0", "localhost", "65536", "a b:1", "\xFF:1", "\"a\":1"}) {
    for (const std::string kind : {"tcp:", "modbus-tcp:", "", "pty:"}) {
      expect_refused({"EX9042D-M", "node-red", {}, kind + tcp}, "--port: ", "HOST:PORT");
    }
  }
  const std::string text = describe({"EX9042D-M", "node-red", {}, "tcp:[fe80::1%eth0]:4001"});
  EXPECT_NE(text.find("\"tcpHost\": \"fe80::1%eth0\""), std::string::npos);
  EXPECT_NE(text.find("\"tcpPort\": \"4001\""), std::string::npos);
}

TEST(Describe, FormatsRefuseTheAddressAndThePortsThatTheyDoNotContain) {
  for (const char* format : {"markdown", "json", "csv", "wb-mqtt-serial", "esphome"}) {
    const std::string has_no = ": --format " + std::string(format) + " has no such option";
    if (std::string(format) != "esphome") {
      expect_refused({"EX9042D-M", format, "01", {}}, "--address" + has_no, "leave it out");
    }
    expect_refused({"EX9042D-M", format, {}, "tcp:5020"}, "--port" + has_no, "leave it out");
  }
}

TEST(Describe, AnUnknownFormatIsRefusedWithAListOfFormats) {
  for (const char* format : {"", "yaml", "Markdown", "json "}) {
    expect_refused({"EX9042D-M", format, {}, {}}, std::string("--format ") + format, format_names());
  }
  EXPECT_EQ(format_names().find("csv|esphome|"), 0U);
}

TEST(Describe, TheHelpHasALineForEachFormat) {
  const std::string help = "\n" + format_help();
  EXPECT_NE(help.find("\n  json            all data as JSON, for programs\n"), std::string::npos) << help;
  EXPECT_NE(help.find("ESPHome (MODEL; --address)\n"), std::string::npos) << help;
  EXPECT_NE(help.find("node-red-contrib-modbus (MODEL; --address, --port)\n"), std::string::npos);
}

}  // namespace
}  // namespace ex9000::sim
