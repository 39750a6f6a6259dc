// Tests captures and the JSON log. Most tests decode the capture with tshark.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "tests/sim/line_monitor/capture/tshark.hpp"
#include "tests/support/control_client.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/socket_client.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {
namespace {

using Bytes = std::vector<std::uint8_t>;

// The values of frame.p2p_dir for frames that the master sends, and for all other frames.
const std::string kSent = "0";
const std::string kReceived = "1";

/// A simulator with `--speed step`, so that the test decides when time passes on the line. `decoded` kills
/// the simulator, and then reads the capture.
class Captured {
 public:
  explicit Captured(std::vector<std::string> arguments) : simulator_(with_capture(std::move(arguments))) {}

  void tell(const std::string& request) { tell(Bytes(request.begin(), request.end())); }
  /// Sends a request, and waits until the request and its replies are recorded.
  void tell(const Bytes& request) {
    client_.send(request);
    control_.ok("advance 1s after " + std::to_string(request.size()) + " quiet");
    pass("100ms");  // longer than any pause in a Modbus frame
  }
  /// Advances the time of the line.
  void pass(const std::string& time) { control_.ok("advance " + time); }

  void wait_for(const std::string& text) { EXPECT_TRUE(simulator_.wait_for(text)); }

  std::vector<Packet> decoded(const std::vector<std::string>& fields) {
    if (!killed_) {
      simulator_.end(SIGKILL);
      killed_ = true;
    }
    return system::decoded(simulator_.directory() + "/line.pcapng", fields);
  }

 private:
  static std::vector<std::string> with_capture(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--port", "tcp:0", "--capture", "line.pcapng", "--speed", "step",
                                       "--control", "control"});
    return arguments;
  }

  SimulatorProcess simulator_;
  SocketClient client_{simulator_.tcp_port()};
  ControlClient control_{simulator_.directory() + "/control"};
  bool killed_ = false;
};

/// A request without its CRC, and the fields that Wireshark shows, as `FIELD=VALUE` with blanks between them
/// and without `modbus.` before each.
struct Exchange {
  Bytes request;
  std::string asked;     ///< for the request
  std::string answered;  ///< for the reply
};

Packet fields_of(const std::string& text) {
  Packet fields;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const auto sign = word.find('=');
    fields["modbus." + word.substr(0, sign)] = word.substr(sign + 1);
  }
  return fields;
}

TEST(Capture, TheDirectionTheUnitTheFunctionTheRegistersAndTheValuesAreDecoded) {
  Captured line({"EX9042D-M@01", "EX9052D-M@02"});
  const std::vector<Exchange> exchanges{
      {{1, 0x05, 0, 2, 0xFF, 0}, "reference_num=2 data=ff00", "reference_num=2 data=ff00"},
      {{1, 0x01, 0, 0, 0, 13}, "reference_num=0 bit_cnt=13", "bitval=0,0,1,0,0,0,0,0,0,0,0,0,0"},
      {{1, 0x01, 0, 2, 0, 1}, "reference_num=2 bit_cnt=1", "bitval=1"},
      {{1, 0x0F, 0, 0, 0, 13, 2, 5, 0x10},
       "reference_num=0 bit_cnt=13 data=0510",
       "reference_num=0 bit_cnt=13"},
      {{2, 0x02, 0, 0, 0, 8}, "reference_num=0 bit_cnt=8", "bitval=0,0,0,0,0,0,0,0"},
      {{2, 0x04, 0, 1, 0, 2}, "reference_num=1 word_cnt=2", "regnum16=1,2 regval_uint16=0,0"},
      {{1, 0x06, 1, 0xE8, 0, 10}, "reference_num=488 data=000a", "reference_num=488 data=000a"},
      {{1, 0x03, 1, 0xE8, 0, 1}, "reference_num=488 word_cnt=1", "regnum16=488 regval_uint16=10"},
      {{1, 0x10, 1, 0xE8, 0, 1, 2, 0, 20},
       "reference_num=488 word_cnt=1 regnum16=488 regval_uint16=20",
       "reference_num=488 word_cnt=1"},
      {{1, 0x01, 3, 0, 0, 1}, "reference_num=768 bit_cnt=1", "exception_code=2"},
  };
  for (const Exchange& each : exchanges) {
    line.tell(with_crc(each.request));
  }
  const std::vector<Packet> packets =
      line.decoded({"frame.p2p_dir", "_ws.col.Protocol", "_ws.col.Info", "frame.comment", "mbrtu.unit_id",
                    "mbrtu.crc16.status", "modbus.func_code", "modbus.request_frame", "modbus.reference_num",
                    "modbus.bit_cnt", "modbus.word_cnt", "modbus.data", "modbus.bitval", "modbus.regnum16",
                    "modbus.regval_uint16", "modbus.exception_code"});
  ASSERT_EQ(packets.size(), 2 * exchanges.size());
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const Exchange& exchange = exchanges[i / 2];
    const bool asks = i % 2 == 0;
    SCOPED_TRACE(exchange.asked + (asks ? ", request" : ", reply"));
    const Packet& packet = packets[i];
    EXPECT_EQ(packet.at("frame.p2p_dir"), asks ? kSent : kReceived);
    EXPECT_EQ(packet.at("_ws.col.Info").find(asks ? "   Query: " : "Response: "), 0U)
        << packet.at("_ws.col.Info");
    const bool answers = !asks && exchange.answered.find("exception") == std::string::npos;
    EXPECT_EQ(packet.at("modbus.request_frame"), answers ? std::to_string(i) : "");
    expect_shown(packet, {{"_ws.col.Protocol", "Modbus RTU"},
                          {"frame.comment", ""},
                          {"mbrtu.unit_id", std::to_string(exchange.request[0])},
                          {"mbrtu.crc16.status", "1"},
                          {"modbus.func_code", std::to_string(exchange.request[1])}});
    expect_shown(packet, fields_of(asks ? exchange.asked : exchange.answered));
  }
}

TEST(Capture, DconIsShownAsText) {
  Captured line({"EX9052D@02", "EX9042D@01"});
  line.tell("$02M\r");
  line.tell("@010005\r");
  const std::vector<Packet> packets =
      line.decoded({"frame.p2p_dir", "_ws.col.Protocol", "text", "frame.comment"});
  const std::vector<std::pair<std::string, std::string>> wanted{
      {kSent, "$02M\\r"}, {kReceived, "!029052\\r"}, {kSent, "@010005\\r"}, {kReceived, ">\\r"}};
  ASSERT_EQ(packets.size(), wanted.size());
  for (std::size_t i = 0; i < packets.size(); ++i) {
    EXPECT_EQ(packets[i].at("frame.p2p_dir"), wanted[i].first);
    EXPECT_EQ(packets[i].at("_ws.col.Protocol"), "DCON");
    EXPECT_EQ(packets[i].at("text").find(wanted[i].second), 0U) << packets[i].at("text");
    EXPECT_EQ(packets[i].at("frame.comment"), "");
  }
}

TEST(Capture, WrongCrcsWrongChecksumsAndCollisionsGetAComment) {
  Captured line({"EX9042D-M@01", "EX9042D-M@01", "EX9052D@02,checksum=on"});
  Bytes wrong = with_crc({1, 5, 0, 2, 0xFF, 0});
  wrong.back() ^= 1U;
  line.tell(wrong);
  line.tell("$022B9\r");
  line.tell(with_crc({1, 1, 0, 0, 0, 1}));  // two modules reply
  const std::vector<Packet> packets = line.decoded(
      {"frame.p2p_dir", "frame.comment", "mbrtu.unit_id", "modbus.func_code", "mbrtu.crc16.status"});
  ASSERT_EQ(packets.size(), 5U);
  expect_shown(packets[0], {{"frame.comment", "wrong CRC"},
                            {"mbrtu.unit_id", "1"},
                            {"modbus.func_code", "5"},
                            {"mbrtu.crc16.status", "0"}});
  EXPECT_EQ(packets[1].at("frame.comment"), "wrong checksum");
  EXPECT_EQ(packets[2].at("frame.comment"), "");
  for (const std::size_t reply : {3U, 4U}) {
    EXPECT_EQ(packets[reply].at("frame.p2p_dir"), kReceived);
    EXPECT_EQ(packets[reply].at("frame.comment"),
              "collision: another station drove the line at the same time");
  }
}

TEST(Capture, EachBusLineOfABusFileIsAnInterface) {
  const Directory directory;
  write_file(directory / "bus.json", R"({"capture": "bus.pcapng", "log": "json", "lines": [
    {"name": "hall", "port": "pty:hall.tty", "modules": [{"model": "EX9042D", "address": "01"}]},
    {"name": "yard", "port": "pty:yard.tty", "modules": [{"model": "EX9052D", "address": "02"}]}]})");
  ChildProcess simulator({simulator_path(), "bus.json"}, directory.path(), ChildProcess::Errors::WithOutput);
  ASSERT_TRUE(simulator.wait_for("press Ctrl-C to end"));
  Terminal yard(directory / "yard.tty", 9600);
  yard.type("$02M\r");
  EXPECT_EQ(yard.read_line(), "!029052\r");
  Terminal hall(directory / "hall.tty", 9600);
  hall.type("$01M\r");
  EXPECT_EQ(hall.read_line(), "!019042D\r");
  EXPECT_EQ(simulator.end(SIGTERM), 0);
  const std::vector<Packet> packets = decoded(directory / "bus.pcapng", {"frame.interface_name", "text"});
  ASSERT_EQ(packets.size(), 4U);
  EXPECT_EQ(packets[1].at("frame.interface_name"), "yard");
  EXPECT_EQ(packets[3].at("frame.interface_name"), "hall");
  EXPECT_NE(simulator.output().find("\n{\"time\":"), std::string::npos) << simulator.output();
  EXPECT_NE(simulator.output().find(R"("line":"yard","from":"02 EX9052D")"), std::string::npos);
}

TEST(Capture, ForeignTrafficIsNotShownAsAReply) {
  Captured line({"EX9042D-M@01", "--fault", "foreign-traffic 0501000000083C48 at 1s", "--log"});
  line.pass("1s");
  line.wait_for("05 01 00 00 00 08 3C 48");
  line.tell(with_crc({1, 1, 0, 0, 0, 1}));
  const std::vector<Packet> packets = line.decoded({"frame.p2p_dir", "_ws.col.Info"});
  ASSERT_EQ(packets.size(), 3U);
  EXPECT_EQ(packets[0].at("frame.p2p_dir"), kReceived);
  EXPECT_EQ(packets[0].at("_ws.col.Info"), "   Query: Unit:   5, Func:   1: Read Coils");
}

TEST(Capture, TwoRunsAtTheSpeedMaxGiveTheSameCapture) {
  const Directory directory;
  for (const char* name : {"a", "b"}) {
    const Finished finished =
        run({simulator_path(), "EX9042D-M@01", "--fault", "foreign-traffic 0101000000083DCC every 1s",
             "--speed", "max", "--for", "10s", "--capture", name},
            directory.path());
    EXPECT_EQ(finished.status, 0) << finished.error;
  }
  EXPECT_EQ(bytes_of_file(directory / "a"), bytes_of_file(directory / "b"));
  const std::vector<Packet> packets = decoded(directory / "a", {"frame.time_epoch", "modbus.func_code"});
  ASSERT_GE(packets.size(), 18U);
  EXPECT_EQ(packets[0].at("frame.time_epoch").substr(0, 4), "1.10");
}

/// Returns the log without the notes about delays of the host. The host is the computer that runs the
/// simulator. Its delays are not the same in each run.
std::string without_delays_of_the_host(const std::string& log) {
  std::string kept;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    kept += line.find("\"note\":\"the host was late by ") == std::string::npos ? line + "\n" : "";
  }
  return kept;
}

TEST(Capture, TheFramesAndTheLogAreTheSameAtThreeSpeeds) {
  const Directory directory;
  // A foreign frame begins every second. The end of the run cuts off the last one.
  write_file(directory / "bus.json", R"({"log": "json", "lines": [{"name": "hall",
    "fault": ["foreign-traffic 0101000000083DCC every 1s", "gone at 5.2s for 1s"],
    "modules": [{"model": "EX9042D-M"}]}]})");
  std::vector<std::string> logs;
  std::vector<std::vector<Packet>> captures;
  for (const char* speed : {"max", "100", "10"}) {
    const Finished finished = run({simulator_path(), "bus.json", "--speed", speed, "--for", "6.005s",
                                   "--capture", std::string("of-") + speed},
                                  directory.path());
    EXPECT_EQ(finished.status, 0) << finished.error;
    logs.push_back(without_delays_of_the_host(finished.output));
    captures.push_back(
        decoded(directory / (std::string("of-") + speed), {"exported_pdu.exported_pdu", "frame.len"}));
  }
  EXPECT_NE(logs[0].find("\n{\"time\":6.1"), std::string::npos) << logs[0];
  EXPECT_GE(captures[0].size(), 6U);
  for (std::size_t i = 1; i < logs.size(); ++i) {
    EXPECT_EQ(logs[i], logs[0]);
    EXPECT_EQ(captures[i], captures[0]);
  }
}

TEST(Capture, TheCommandPlayWritesOneInterfaceForEachRun) {
  const Directory directory;
  write_file(directory / "a.txt",
             "source: manual\nmodel: EX9042D-M\nmodel: EX9043D-M\npreset: protocol=modbus\n\n"
             "=> 01 05 0002 FF00\n<= 01 05 0002 FF00\n");
  const Finished finished =
      run({simulator_path(), "play", "a.txt", "--capture", "line.pcapng", "--log", "json"}, directory.path());
  EXPECT_EQ(finished.status, 0) << finished.error;
  EXPECT_NE(finished.error.find("2 runs, 4 steps, 0 failed"), std::string::npos) << finished.error;
  std::istringstream lines(finished.output);
  std::size_t frames = 0;
  for (std::string line; std::getline(lines, line);) {
    const auto entry = nlohmann::json::parse(line, nullptr, false);
    EXPECT_FALSE(entry.is_discarded()) << line;
    frames += entry.contains("bytes") ? 1U : 0U;
  }
  EXPECT_EQ(frames, 4U);
  const std::vector<Packet> packets =
      decoded(directory / "line.pcapng",
              {"frame.interface_name", "modbus.func_code", "modbus.reference_num", "frame.p2p_dir"});
  ASSERT_EQ(packets.size(), 4U);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    expect_shown(packets[i], {{"frame.interface_name", i < 2 ? "a.txt (EX9042D-M)" : "a.txt (EX9043D-M)"},
                              {"modbus.func_code", "5"},
                              {"modbus.reference_num", "2"},
                              {"frame.p2p_dir", i % 2 == 0 ? kSent : kReceived}});
  }
}

TEST(Capture, WiresharkDoesNotNameFunction46AndDoesNotDecodeFourByteRequestsOrBroadcasts) {
  Captured line({"EX9042D-M@01"});
  line.tell(with_crc({1, 0x46, 0}));
  line.tell(with_crc({1, 0x11}));
  line.tell(with_crc({1, 0x08, 0, 0, 0x12, 0x34}));
  line.tell(with_crc({0, 0x05, 0, 1, 0xFF, 0}));
  const std::vector<Packet> packets =
      line.decoded({"_ws.col.Info", "_ws.col.Protocol", "exported_pdu.exported_pdu", "mbrtu.unit_id",
                    "modbus.func_code", "modbus.data", "modbus.diagnostic_code", "data.data"});
  ASSERT_EQ(packets.size(), 7U);
  // Wireshark has no name for function 0x46.
  EXPECT_NE(packets[0].at("_ws.col.Info").find("Query"), std::string::npos);
  EXPECT_NE(packets[0].at("_ws.col.Info").find("Unknown function (70)"), std::string::npos);
  EXPECT_EQ(packets[0].at("modbus.func_code"), "70");
  EXPECT_EQ(packets[1].at("modbus.data").substr(0, 2), "00");
  // Wireshark does not decode a frame of four bytes.
  expect_shown(packets[2], {{"mbrtu.unit_id", ""}, {"modbus.func_code", ""}, {"data.data", "0111c02c"}});
  EXPECT_EQ(packets[3].at("modbus.func_code"), "17");
  EXPECT_EQ(packets[4].at("modbus.diagnostic_code"), "0");
  // Wireshark does not decode a broadcast.
  expect_shown(packets[6], {{"mbrtu.unit_id", ""}, {"exported_pdu.exported_pdu", "00050001ff00dc2b"}});
  for (const Packet& packet : packets) {
    EXPECT_EQ(packet.at("_ws.col.Protocol"), "Modbus RTU");
  }
}

TEST(Capture, TimestampsAreWithinTheRunAndDifferByTheLineTimeBetweenTheFrames) {
  const auto wall = [] {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  };
  const double before = wall();
  SimulatorProcess simulator({"EX9042D-M@01", "--port", "tcp:0", "--capture", "line.pcapng"});
  SocketClient client(simulator.tcp_port());
  client.send(with_crc({1, 1, 0, 0, 0, 1}));
  EXPECT_EQ(client.receive(6).size(), 6U);
  const double after = wall();
  simulator.end(SIGTERM);
  const std::vector<Packet> packets =
      decoded(simulator.directory() + "/line.pcapng", {"frame.time_epoch", "frame.interface_name"});
  ASSERT_EQ(packets.size(), 2U);
  const double asked = std::stod(packets[0].at("frame.time_epoch"));
  const double answered = std::stod(packets[1].at("frame.time_epoch"));
  EXPECT_GT(asked, before);
  EXPECT_LT(answered, after);
  // The reply begins after the eight characters of the request and a silence of 3.5 characters of 11 bits
  // (wire.md section 7). The formula uses 10 bits for the 3.5 characters too. The tolerance covers the
  // difference of 0.36 ms.
  EXPECT_NEAR(answered - asked, (8 + 3.5) * 10 / 9600, 0.001);
  EXPECT_EQ(packets[0].at("frame.interface_name").find("127.0.0.1:"), 0U);
}

TEST(Capture, AnUnfinishedFrameIsWrittenAtAnOrderlyExit) {
  SimulatorProcess simulator(
      {"EX9042D@01", "--capture", "line.pcapng", "--log", "--speed", "step", "--control", "control"});
  ControlClient control(simulator.directory() + "/control");
  Terminal terminal(simulator.tty(), 9600);
  terminal.type("$01M\r");
  control.ok("advance 1s after 5 quiet");
  EXPECT_EQ(terminal.read_line(), "!019042D\r");
  terminal.type("$01");
  control.ok("advance 20ms after 3");
  EXPECT_EQ(simulator.end(SIGTERM), 0);
  const std::vector<Packet> packets = decoded(simulator.directory() + "/line.pcapng", {"text"});
  ASSERT_EQ(packets.size(), 3U);
  EXPECT_EQ(packets[2].at("text").find("$01"), 0U) << packets[2].at("text");
}

TEST(Capture, AWriteErrorEndsTheProgramWithOneLineAndLeavesNoCreatedFiles) {
  const Directory directory;
  const Finished finished =
      run({simulator_path(), "EX9042D@01,eeprom=n.bin", "--capture", "/dev/full"}, directory.path());
  EXPECT_EQ(finished.status, 1);
  EXPECT_EQ(finished.error, "ex9000-sim: --capture: /dev/full: cannot be written: No space left on device\n");
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
  write_file(directory / "a.txt", "> $01M\n< !019042D\n");
  for (const char* arguments : {" EX9042D@01", " EX9042D@01,eeprom=n.bin", " play a.txt EX9042D"}) {
    const std::string command =
        "ulimit -f 0; exec " + simulator_path() + arguments + " --capture line.pcapng";
    const Finished limited = run({"sh", "-c", command}, directory.path());
    EXPECT_EQ(limited.status, std::string(arguments).find("n.bin") == std::string::npos ? 1 : 2)
        << limited.error;
    EXPECT_EQ(std::count(limited.error.begin(), limited.error.end(), '\n'), 1) << limited.error;
    EXPECT_FALSE(std::filesystem::exists(directory / "line.pcapng"));
    EXPECT_FALSE(std::filesystem::exists(directory / "n.bin"));
  }
}

// --- the JSON log ---

TEST(JsonLog, IsTheOnlyTextOnStandardOutput) {
  const Directory directory;
  ChildProcess simulator(
      {"sh", "-c", "exec " + simulator_path() + " EX9042D@01 EX9052D@02,baud=19200 --log json > log"},
      directory.path(), ChildProcess::Errors::WithOutput);
  ASSERT_TRUE(simulator.wait_for("press Ctrl-C to end"));
  Terminal terminal(directory / "ex9000.tty", 9600);
  terminal.type("$01M\r");
  EXPECT_EQ(terminal.read_line(), "!019042D\r");
  EXPECT_EQ(simulator.end(SIGTERM), 0);
  std::vector<nlohmann::json> objects;
  std::string line;
  for (std::istringstream lines(without_delays_of_the_host(bytes_of_file(directory / "log")));
       std::getline(lines, line);) {
    objects.push_back(nlohmann::json::parse(line));
    EXPECT_EQ(objects.back()["line"], "ex9000.tty");
    EXPECT_TRUE(objects.back()["time"].is_number());
  }
  ASSERT_EQ(objects.size(), 3U);
  EXPECT_EQ(objects[0]["note"], "the line is at 9600 baud 8N1, EX9052D at 02 listens at 19200 baud 8N1");
  EXPECT_EQ(objects[1]["from"], "master");
  EXPECT_EQ(objects[1]["text"], "$01M\r");
  EXPECT_EQ(objects[2]["from"], "01 EX9042D");
  EXPECT_EQ(objects[2]["bytes"], "21303139303432440D");
}

}  // namespace
}  // namespace ex9000::system
