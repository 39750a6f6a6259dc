// Tests that a scan finds every module of a line once, in ascending order of the serial numbers, whatever
// else happens on the line, and that a request by serial number reaches one module: extensions.md, scan.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "sim/notation/fault_notation.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/values.hpp"
#include "sim/virtual_line/line/line.hpp"
#include "tests/sim/virtual_line/line/scan_master.hpp"
#include "tests/support/environment.hpp"

namespace ex9000::sim {
namespace {

using Bytes = ScanMaster::Bytes;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr std::uint8_t kBaud9600 = 0x06;
constexpr std::uint8_t kBaud115200 = 0x0A;

/// With different serial numbers and random addresses.
std::vector<ModuleSpec> plant(std::mt19937& random, std::size_t size, unsigned baud_code) {
  std::vector<ModuleSpec> modules;
  std::set<unsigned> used;
  while (modules.size() < size) {
    const unsigned low = random() % 0x10000;
    if (used.insert(low).second) {
      ModuleSpec spec = parse_module_spec("EX9042D-M@01,protocol=modbus");
      spec.serial_number = 0x0D000000 + low;
      spec.settings.address = static_cast<std::uint8_t>(1 + random() % 247);
      spec.settings.baud_code = static_cast<std::uint8_t>(baud_code);
      modules.push_back(spec);
    }
  }
  return modules;
}

std::vector<ModuleSpec> modules(const std::vector<std::string>& texts) {
  std::vector<ModuleSpec> specs;
  for (const std::string& text : texts) {
    specs.push_back(parse_module_spec(text));
  }
  return specs;
}

std::vector<ScanMaster::Found> in_order(const std::vector<ModuleSpec>& modules) {
  std::vector<ScanMaster::Found> all;
  for (const ModuleSpec& module : modules) {
    all.push_back({module.serial_number, module.settings.address});
  }
  std::sort(all.begin(), all.end());
  return all;
}

// EX9000_SCANS=1000 for the whole set.
TEST(Scan, FindsEveryModuleOnceInOrderAtEveryRateInEveryFormat) {
  const auto scans = static_cast<unsigned>(number_in_environment("EX9000_SCANS", 32));
  for (unsigned seed = 0; seed < scans; ++seed) {
    std::mt19937 random(seed);
    const unsigned baud_code = (seed % 4 << 6U) + 3 + seed / 4 % 8;
    const auto all = plant(random, 1 + random() % (scans > 32 ? 247 : 12), baud_code);
    ScanMaster master(all);
    EXPECT_EQ(master.scan(), in_order(all)) << "EX9000_SCANS, seed " << seed;
  }
}

TEST(Scan, Finds247ModulesInTenMillisecondsEach) {
  std::mt19937 random(1);
  const auto all = plant(random, 247, kBaud115200);
  ScanMaster master(all);
  const VirtualTime begun = master.line().clock().virtual_now();
  EXPECT_EQ(master.scan(), in_order(all));
  EXPECT_LT(master.line().clock().virtual_now() - begun, 248 * milliseconds(10));
}

// wb-modbus-scanner asks for the next round 0.84 ms after a reply, above 19200 baud sooner than T3.5. For a
// module that has lost, the bytes FF, the reply and the request are then one frame.
TEST(Scan, TheNextRoundMayBeginSoonerThanTheSilenceAfterAReply) {
  std::mt19937 random(5);
  for (unsigned baud_code = kBaud9600; baud_code <= kBaud115200; ++baud_code) {
    for (const LineKind kind : {kPaced, kStrictlyPaced}) {
      const auto all = plant(random, 6, baud_code);
      ScanMaster master(all, kind);
      master.gap = baud_code > 7 ? microseconds(800) : microseconds(4500);
      EXPECT_EQ(master.scan(), in_order(all)) << baud_code;
    }
  }
}

// With a skew of 30 us, the bytes FF of two modules merge into others, with which the loser's frame begins.
TEST(Scan, TheNextRoundMayBeginSoonerAlsoAfterBytesThatHaveMerged) {
  for (const std::string baud : {"57600", "115200"}) {
    const std::string common = ",protocol=modbus,baud=" + baud + ",serial=";
    const auto all =
        modules({"EX9042D-M@01" + common + "1230,skew=30us", "EX9042D-M@02" + common + "1231,skew=0us",
                 "EX9042D-M@03" + common + "F231,skew=0us"});
    ScanMaster master(all);
    master.gap = microseconds(840);
    EXPECT_EQ(master.scan(), in_order(all)) << baud;
  }
}

// wire.md 7: the byte 00 of a turn-around does not spoil the frame after it.
TEST(Scan, ATurnAroundByteMayPrecedeTheRequest) {
  for (const std::string baud : {"9600", "115200"}) {
    ScanMaster master(modules({"EX9042D-M@01,protocol=modbus,serial=0001,baud=" + baud}));
    Bytes request = with_crc({0xFD, 0x46, 0x01});
    request.insert(request.begin(), 0x00);
    EXPECT_EQ(ScanMaster::frame_of(master.put(request, 1000)),
              (Bytes{0xFD, 0x46, 0x03, 0x0D, 0x00, 0x00, 0x01, 0x01}))
        << baud;
  }
}

TEST(Scan, OnlyACorrectRequestAfterOtherBytesBeginsARound) {
  ScanMaster master(modules({"EX9042D-M@01,protocol=modbus,serial=0001,baud=115200"}));
  for (std::size_t changed = 0; changed < 5; ++changed) {
    Bytes request = with_crc({0xFD, 0x46, 0x01});
    request[changed] ^= 0x04;
    request.insert(request.begin(), 4, 0xFF);
    EXPECT_EQ(master.put(request, 1000), Bytes{}) << changed;
  }
}

/// When a driver other than the master's goes on for the first time, and the master's goes off.
struct FirstBurst final : WireObserver {
  void driver(std::size_t station, bool on, VirtualTime now) override {
    if (station == 0 && !on) {
      request = now;
    }
    if (station != 0 && on && burst == VirtualTime(0)) {
      burst = now;
    }
  }
  void byte(std::size_t, std::uint8_t, SerialMode, bool, VirtualTime, VirtualTime) override {}
  VirtualTime request{0};
  VirtualTime burst{0};
};

// 42 bits, at least 800 us rounded up to whole bits, after the last stop bit. The first bit of a word is a 0.
TEST(Scan, TheFirstWindowBeginsAfterTheLastStopBitAtEveryRateInEveryFormat) {
  for (const unsigned format : {0x00U, 0x40U, 0x80U, 0xC0U}) {
    for (unsigned rate = kFirstBaudCode; rate <= kLastBaudCode; ++rate) {
      std::mt19937 random(6);
      auto all = plant(random, 1, format | rate);
      all[0].skew = VirtualTime(0);
      ScanMaster master(all);
      FirstBurst first;
      master.line().wires().observe(first);
      master.round(0x01);
      const double bit = 1e6 / baud_rate(all[0].settings.baud_code);
      const double expected = std::max(42.0, std::ceil(800 / bit)) * bit;
      const double measured = std::chrono::duration<double, std::micro>(first.burst - first.request).count();
      EXPECT_NEAR(measured, expected, 6) << format << " " << rate;
    }
  }
}

TEST(Scan, ASecondScanFindsAllAgain) {
  std::mt19937 random(2);
  const auto all = plant(random, 5, kBaud9600);
  ScanMaster master(all);
  EXPECT_EQ(master.scan(), in_order(all));
  EXPECT_EQ(master.scan(), in_order(all));
}

TEST(Scan, NobodyReplaysOnALineWithoutModulesThatTakePart) {
  ScanMaster master(modules({"EX9042D-M@01,protocol=ascii", "EX9042D-M@02,protocol=modbus,init=on"}));
  EXPECT_EQ(master.round(0x01), Bytes{});
}

TEST(Scan, AModuleWithoutASerialNumberTakesNoPart) {
  ScanMaster master(modules({"EX9042D-M@01,protocol=modbus"}));
  EXPECT_EQ(master.round(0x01), Bytes{});
}

// wire.md 7: a gap of more than T1.5 makes a frame invalid. The arbitration begins after a longer one.
TEST(Scan, WorksIfGapsInFramesAreLimited) {
  std::mt19937 random(4);
  for (const unsigned baud_code : {kBaud9600, kBaud115200}) {
    const auto all = plant(random, 4, baud_code);
    ScanMaster master(all, kStrictlyPaced);
    EXPECT_EQ(master.scan(), in_order(all));
  }
}

TEST(Scan, ARequestWithAParityErrorBeginsNoRound) {
  for (std::size_t damaged = 0; damaged < 5; ++damaged) {
    ScanMaster master(modules({"EX9042D-M@01,protocol=modbus,format=8E1,serial=0001"}));
    const Bytes round = with_crc({0xFD, 0x46, 0x01});
    master.line().master().send(round.data(), round.size(), VirtualTime(0), {damaged});
    EXPECT_EQ(master.put({}, 900), Bytes{}) << damaged;
  }
}

TEST(Scan, FramesOfAForeignModuleBetweenTheRoundsChangeNothing) {
  std::mt19937 random(3);
  const auto all = plant(random, 6, kBaud115200);
  ScanMaster master(all);
  master.between = [&] {
    master.ask({0x63, 0x03, 0x02, 0x00, 0x01}, 200);
    master.ask({0xFD, 0x46, 0x03, 0x0D, 0x00, 0x00, 0x00, 0x09}, 200);
    master.ask({0xFD, 0x46, 0x04}, 200);
    master.ask({0x00, 0x05, 0x00, 0x00, 0xFF, 0x00}, 200);
  };
  EXPECT_EQ(master.scan(), in_order(all));
}

TEST(Scan, TwoModulesWithOneAddressGetTheirOwnBySerialNumber) {
  ScanMaster master(
      modules({"EX9042D-M@01,protocol=modbus,serial=0A0A", "EX9043D-M@01,protocol=modbus,serial=0A0B"}));
  const std::vector<ScanMaster::Found> both{{0x0D000A0A, 1}, {0x0D000A0B, 1}};
  EXPECT_EQ(master.scan(), both);
  EXPECT_EQ(ScanMaster::frame_of(
                master.ask({0xFD, 0x46, 0x08, 0x0D, 0x00, 0x0A, 0x0B, 0x06, 0x00, 0x80, 0x00, 0x02}, 500)),
            (Bytes{0xFD, 0x46, 0x09, 0x0D, 0x00, 0x0A, 0x0B, 0x06, 0x00, 0x80, 0x00, 0x02}));
  const std::vector<ScanMaster::Found> apart{{0x0D000A0A, 1}, {0x0D000A0B, 2}};
  EXPECT_EQ(master.scan(), apart);
  EXPECT_EQ(ScanMaster::frame_of(master.ask({0x02, 0x03, 0x00, 0x80, 0x00, 0x01}, 500)),
            (Bytes{0x02, 0x03, 0x02, 0x00, 0x02}));
}

TEST(Scan, AModuleThatStoresWhenTheFirstWindowBeginsTakesNoPart) {
  ScanMaster master(modules({"EX9042D-M@01,protocol=modbus,serial=0001,baud=115200",
                             "EX9042D-M@02,protocol=modbus,serial=0002,baud=115200"}));
  const Bytes store = with_crc({0x01, 0x06, 0x01, 0xE8, 0x00, 0x05});
  master.line().master().send(store.data(), store.size());
  master.line().wires().run_for(master.line().master().takes(store.size()) + milliseconds(2));
  const std::vector<ScanMaster::Found> only{{0x0D000002, 2}};
  master.between = [&] { master.line().wires().run_for(milliseconds(100)); };
  EXPECT_EQ(ScanMaster::frame_of(master.round(0x01)),
            (Bytes{0xFD, 0x46, 0x03, 0x0D, 0x00, 0x00, 0x02, 0x02}));
}

TEST(Scan, AResetModuleIsUnscannedAgain) {
  ScanMaster master(
      modules({"EX9042D-M@01,protocol=modbus,serial=0001", "EX9042D-M@02,protocol=modbus,serial=0002"}));
  EXPECT_EQ(master.scan().size(), 2U);
  master.line().module(1).reset();
  master.line().wires().run_for(milliseconds(100));
  EXPECT_EQ(ScanMaster::frame_of(master.round(0x02)),
            (Bytes{0xFD, 0x46, 0x03, 0x0D, 0x00, 0x00, 0x02, 0x02}));
  EXPECT_EQ(ScanMaster::frame_of(master.round(0x02)), (Bytes{0xFD, 0x46, 0x04}));
}

// A byte before the first window belongs to a frame again: this one is too long for a round.
TEST(Scan, ABytePastTheRequestEndsTheArbitration) {
  ScanMaster master(modules({"EX9042D-M@01,protocol=modbus,baud=115200,serial=0001"}));
  Bytes frame = with_crc({0xFD, 0x46, 0x01});
  frame.push_back(0x00);
  EXPECT_EQ(master.put(frame, 1000), Bytes{});
  EXPECT_EQ(master.scan().size(), 1U);
}

// At any time after a round has begun. If it does not meet a byte FF, the module executes it; the arbitration
// is over for the module.
TEST(Scan, ARequestInTheMiddleIsExecutedOrDamagedAndTheNextScanIsRight) {
  unsigned executed = 0;
  for (unsigned after = 0; after < 40; ++after) {
    ScanMaster master(modules({"EX9042D-M@01,protocol=modbus,serial=FFFF"}));
    const Bytes round = with_crc({0xFD, 0x46, 0x01});
    master.line().master().send(round.data(), round.size());
    master.line().wires().run_for(master.line().master().takes(round.size()) + after * microseconds(1300));
    const Bytes reply = ScanMaster::frame_of(master.ask({0x01, 0x03, 0x00, 0x80, 0x00, 0x01}, 1000));
    const bool replied = reply == Bytes{0x01, 0x03, 0x02, 0x00, 0x01};
    const bool won = reply == Bytes{0xFD, 0x46, 0x03, 0x0D, 0x00, 0xFF, 0xFF, 0x01};
    EXPECT_TRUE(replied || won || reply.empty()) << hex_text(reply, " ");
    executed += replied ? 1 : 0;
    EXPECT_EQ(master.scan().size(), 1U) << after;
  }
  EXPECT_GT(executed, 5U);
}

/// Spoils random bytes, and puts bytes on the idle line.
class Noise final : public Disturbance {
 public:
  explicit Noise(unsigned seed) : random_(seed) {}
  Levels disturbed(const Sent& sent) override {
    constexpr unsigned kRare = 150;
    return random_() % kRare == 0 ? static_cast<Levels>(sent.levels ^ 1U << random_() % 10) : sent.levels;
  }

 private:
  std::mt19937 random_;
};

// A found module exists, with its own address; what noise has hidden, a repeated scan finds.
TEST(Scan, NoiseCostsAtMostARepeatedScanAndNeverAWrongAddress) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    std::mt19937 random(seed);
    const auto all = plant(random, 1 + random() % 8, kBaud115200);
    const auto expected = in_order(all);
    ScanMaster master(all);
    master.tolerant = true;
    Noise noise(seed);
    master.line().wires().disturb(noise);
    std::set<ScanMaster::Found> found;
    for (unsigned scan = 0; scan < 20 && found.size() < expected.size(); ++scan) {
      for (const ScanMaster::Found each : master.scan()) {
        EXPECT_NE(std::find(expected.begin(), expected.end(), each), expected.end()) << each;
        found.insert(each);
      }
    }
    EXPECT_EQ(found.size(), expected.size()) << seed;
  }
}

// The bytes FF of an arbitration are no replies.
TEST(Scan, FaultsOfRepliesConcernTheReplyOfARound) {
  ScanMaster master(modules({"EX9042D-M@01,protocol=modbus,serial=0001"}));
  master.line().configure_faults(1, [](const std::string&) {});
  master.line().faults().add(parse_fault("lost-reply every 2nd reply", 0));
  EXPECT_EQ(ScanMaster::frame_of(master.round(0x01)),
            (Bytes{0xFD, 0x46, 0x03, 0x0D, 0x00, 0x00, 0x01, 0x01}));
  EXPECT_EQ(master.round(0x02), Bytes(24, 0xFF));
  EXPECT_EQ(ScanMaster::frame_of(master.round(0x02)), (Bytes{0xFD, 0x46, 0x04}));
}

TEST(Scan, AnExceptionByAFaultHasThePrefixOfAReplyBySerialNumber) {
  ScanMaster master(modules({"EX9042D-M@01,protocol=modbus,serial=0001"}));
  master.line().configure_faults(1, [](const std::string&) {});
  master.line().faults().add(parse_fault("exception 06 every 1st reply", 0));
  EXPECT_EQ(master.ask({0xFD, 0x46, 0x08, 0x0D, 0x00, 0x00, 0x01, 0x03, 0x00, 0x80, 0x00, 0x01}, 500),
            with_crc({0xFD, 0x46, 0x09, 0x0D, 0x00, 0x00, 0x01, 0x83, 0x06}));
}

// The limit is what a window is longer than a byte: at 9600 baud, three bits. The late module has the lower
// number, but the other does not hear its last byte FF in time.
TEST(Scan, ModulesWhoseWindowsDifferTooMuchAreNotToldApart) {
  for (const bool too_much : {false, true}) {
    const std::string skew = too_much ? "400us" : "250us";
    const auto all = modules({"EX9042D-M@01,protocol=modbus,serial=1235,skew=0us",
                              "EX9042D-M@02,protocol=modbus,serial=1234,skew=" + skew});
    ScanMaster master(all);
    master.tolerant = too_much;
    EXPECT_EQ(master.scan() == in_order(all), !too_much) << skew;
  }
}

}  // namespace
}  // namespace ex9000::sim
