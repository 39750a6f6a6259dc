// Tests sim::Capture directly, without the program ex9000-sim. The tests decode the captures with tshark.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/line_monitor/capture/capture.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/virtual_line/line/line.hpp"
#include "tests/sim/line_monitor/capture/tshark.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::system {
namespace {

using Bytes = std::vector<std::uint8_t>;

sim::Frame frame_of(std::size_t station, const Bytes& bytes) {
  sim::Frame frame;
  frame.station = station;
  frame.bytes = bytes;
  return frame;
}

TEST(Capture, EachLineIsAnInterfaceWithItsOwnRequests) {
  const Directory directory;
  sim::Capture capture(directory / "lines.pcapng", "--capture: ");
  capture.begin();
  const std::size_t pumps = capture.add_line("pumps", 1, std::chrono::seconds(1));
  const std::size_t doors = capture.add_line("doors", 1, std::chrono::seconds(2));
  const Bytes of_coil_0 = with_crc({1, 1, 0, 0, 0, 1});
  const Bytes of_coil_8 = with_crc({1, 1, 0, 8, 0, 1});
  const Bytes reply = with_crc({1, 1, 1, 1});
  capture.write(pumps, frame_of(0, of_coil_0));
  capture.write(doors, frame_of(0, of_coil_8));
  capture.write(pumps, frame_of(1, reply));
  capture.write(doors, frame_of(1, reply));
  const std::vector<Packet> packets =
      decoded(directory / "lines.pcapng",
              {"frame.interface_name", "frame.time_epoch", "modbus.request_frame", "modbus.bitnum"});
  ASSERT_EQ(packets.size(), 4U);
  expect_shown(packets[2], {{"frame.interface_name", "pumps"},
                            {"frame.time_epoch", "1.000000000"},
                            {"modbus.request_frame", "1"},
                            {"modbus.bitnum", "0"}});
  expect_shown(packets[3], {{"frame.interface_name", "doors"},
                            {"frame.time_epoch", "2.000000000"},
                            {"modbus.request_frame", "2"},
                            {"modbus.bitnum", "8"}});
}

/// Changes one byte on the line: inverts each level whose bit in `mask` is 1. `byte` is the position of this
/// byte among the sent bytes, counted from 0.
class OneHit final : public sim::Disturbance {
 public:
  OneHit(unsigned byte, sim::Levels mask) : byte_(byte), mask_(mask) {}
  sim::Levels disturbed(const Sent& sent) override {
    return static_cast<sim::Levels>(byte_-- == 0 ? sent.levels ^ mask_ : sent.levels);
  }

 private:
  unsigned byte_;
  sim::Levels mask_;
};

/// Returns the packet of a captured request after `hit` has changed one of its bytes.
Packet of_a_spoiled(const Bytes& request, OneHit hit) {
  const Directory directory;
  sim::Line line({sim::parse_module_spec("EX9042D-M@01")}, sim::kPaced, [](std::uint8_t, ByteStatus) {});
  line.come_up();
  sim::Capture capture(directory / "line.pcapng", "--capture: ");
  sim::FrameWatch frames([&line] { return line.master().mode(); });
  line.wires().observe(frames);
  line.wires().disturb(hit);
  capture.begin();
  const std::size_t number = capture.add_line("line", 1, std::chrono::seconds(0));
  frames.add_receiver([&](const sim::Frame& frame) { capture.write(number, frame); });
  line.master().send(request.data(), request.size());
  line.wires().run_for(std::chrono::milliseconds(100));
  frames.finish();
  const std::vector<Packet> packets = decoded(
      directory / "line.pcapng", {"frame.comment", "mbrtu.crc16.status", "modbus.reference_num", "text"});
  EXPECT_EQ(packets.size(), 1U);
  return packets.empty() ? Packet() : packets[0];
}

TEST(Capture, ADamagedByteIsShownAsReceivedAndDescribedInAComment) {
  const Bytes request = with_crc({1, 5, 0, 2, 0xFF, 0});
  expect_shown(of_a_spoiled(request, OneHit(3, 1U << 3U)),
               {{"frame.comment", "noise: byte 4: 06 instead of 02; wrong CRC"},
                {"mbrtu.crc16.status", "0"},
                {"modbus.reference_num", "6"}});
  EXPECT_EQ(of_a_spoiled(request, OneHit(3, 1U << 9U)).at("frame.comment"), "noise: byte 4: framing error");
  EXPECT_EQ(of_a_spoiled(request, OneHit(2, 1U << 9U)).at("frame.comment"),
            "noise: byte 3: break instead of 00");
  EXPECT_EQ(of_a_spoiled(request, OneHit(0, 1U)).at("frame.comment"),
            "noise: byte 1: 01 is lost because its start bit is missing; wrong CRC");
}

TEST(Capture, DconIsShownAsTextEvenIfAByteIsDamaged) {
  const std::string request = "$01M\r";
  const Packet packet = of_a_spoiled(Bytes(request.begin(), request.end()), OneHit(2, 1U << 8U));
  EXPECT_EQ(packet.at("frame.comment"),
            "noise: byte 3: B1 instead of 31; contains characters that are not printable");
  EXPECT_EQ(packet.at("text").find("$0"), 0U) << packet.at("text");
}

}  // namespace
}  // namespace ex9000::system
