// Tests the notes that say why no module replies.
#include "sim/app/running_line/hints.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/app/running_line/line_record.hpp"
#include "sim/notation/module_notation.hpp"

namespace ex9000::sim {
namespace {

FrameBytes text(const std::string& command) { return {command.begin(), command.end()}; }

class Hints : public testing::Test {
 protected:
  static std::unique_ptr<Line> line_of(const std::vector<std::string>& modules) {
    std::vector<ModuleSpec> specs;
    for (const std::string& module : modules) {
      specs.push_back(parse_module_spec(module));
    }
    auto line = std::make_unique<Line>(specs, kPaced, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
    line->come_up();
    return line;
  }
  static std::string hint(const Line& line, FrameBytes bytes, std::size_t station = 0) {
    Frame frame;
    frame.station = station;
    frame.bytes = std::move(bytes);
    return hint_for(frame, line);
  }
};

TEST_F(Hints, ARequestToAnAddressThatNoModuleHas) {
  const auto line = line_of({"EX9042D@05", "EX9042D-M@06"});
  EXPECT_EQ(hint(*line, text("$01M\r")), "no module that speaks ASCII has the address 01");
  EXPECT_EQ(hint(*line, text("$06M\r")), "no module that speaks ASCII has the address 06");
  EXPECT_EQ(hint(*line, with_crc({0x01, 0x01, 0x00, 0x00, 0x00, 0x0D})),
            "no module that speaks Modbus RTU has the address 01");
  EXPECT_EQ(hint(*line, with_crc({0x05, 0x01, 0x00, 0x00, 0x00, 0x0D})),
            "no module that speaks Modbus RTU has the address 05");
  EXPECT_EQ(hint(*line, text("$05M\r")), "");
  EXPECT_EQ(hint(*line, with_crc({0x06, 0x01, 0x00, 0x00, 0x00, 0x0D})), "");
}

TEST_F(Hints, ARequestInAProtocolThatNoModuleSpeaks) {
  EXPECT_EQ(hint(*line_of({"EX9042D-M@01"}), text("$01M\r")),
            "no module speaks ASCII, the protocol of this request");
  EXPECT_EQ(hint(*line_of({"EX9042D@01"}), with_crc({0x01, 0x01, 0x00, 0x00, 0x00, 0x0D})),
            "no module speaks Modbus RTU, the protocol of this request");
}

TEST_F(Hints, AReadAtAddress0AndAReservedAddress) {
  const auto line = line_of({"EX9042D-M@01"});
  EXPECT_EQ(hint(*line, with_crc({0x00, 0x01, 0x00, 0x00, 0x00, 0x0D})),
            "modules ignore a read at address 00, because they do not reply to a broadcast");
  EXPECT_EQ(hint(*line, with_crc({0x00, 0x05, 0x00, 0x00, 0xFF, 0x00})), "");
  for (const std::uint8_t address : {std::uint8_t{0xF8}, std::uint8_t{0xFF}}) {
    EXPECT_NE(hint(*line, with_crc({address, 0x01, 0x00, 0x00, 0x00, 0x0D})).find("F8 to FF are reserved"),
              std::string::npos);
  }
  EXPECT_EQ(hint(*line_of({"EX9042D-M@F7"}), with_crc({0xF7, 0x01, 0x00, 0x00, 0x00, 0x0D})), "");
}

TEST_F(Hints, BytesOfModbusTcp) {
  const auto line = line_of({"EX9042D-M@01"});
  const std::string expected =
      "these bytes look like Modbus TCP; use --port modbus-tcp:PORT, or set the master to Modbus RTU over "
      "TCP";
  const FrameBytes request{0x00, 0x01, 0x00, 0x00, 0x00, 0x06, 0x01, 0x01, 0x00, 0x00, 0x00, 0x0D};
  EXPECT_EQ(hint(*line, request), expected);
  FrameBytes two = request;
  two.insert(two.end(), request.begin(), request.end());
  EXPECT_EQ(hint(*line, two), expected);
  for (std::size_t size = 0; size < request.size(); ++size) {
    EXPECT_EQ(hint(*line, {request.begin(), request.begin() + static_cast<std::ptrdiff_t>(size)}), "")
        << size;
  }
  // A broadcast that writes 0 to coil 0 begins with the same bytes, but has a right CRC.
  EXPECT_EQ(hint(*line, with_crc({0x00, 0x05, 0x00, 0x00, 0x00, 0x00})), "");
}

TEST_F(Hints, NoHintForABroadcastADamagedFrameAReplyOrWhileAModuleHasNoPower) {
  const auto line = line_of({"EX9042D@05", "EX9042D-M@06"});
  EXPECT_EQ(hint(*line, text("~**\r")), "");
  EXPECT_EQ(hint(*line, text("$01")), "");
  EXPECT_EQ(hint(*line, {0x01, 0x01, 0x00, 0x00, 0x00, 0x0D, 0x00, 0x00}), "");
  EXPECT_EQ(hint(*line, text("!01\r"), 1), "");
  line->module(0).power(false);
  EXPECT_EQ(hint(*line, text("$01M\r")), "");
}

TEST_F(Hints, EachIsNotedOnceAfterItsFrame) {
  const auto line = line_of({"EX9042D@05"});
  std::vector<std::string> log;
  LineRecord record(*line, "line", LogFormat::Text, [&log](const std::string& entry) {
    log.push_back(entry.substr(entry.find_first_not_of(' ') + 8));
  });
  record.give_hints();
  record.print_frames();
  for (const char* command : {"$01M\r", "$01M\r", "$02M\r"}) {
    const FrameBytes bytes = text(command);
    line->master().send(bytes.data(), bytes.size());
    line->wires().run_for(std::chrono::milliseconds(100));
  }
  EXPECT_EQ(log, (std::vector<std::string>{"  > master  $01M\\r  ; $AAM: read the module's name",
                                           "  - no module that speaks ASCII has the address 01",
                                           "  > master  $01M\\r  ; $AAM: read the module's name",
                                           "  > master  $02M\\r  ; $AAM: read the module's name",
                                           "  - no module that speaks ASCII has the address 02"}));
}

}  // namespace
}  // namespace ex9000::sim
