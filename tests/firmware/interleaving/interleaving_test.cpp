// Tests interrupts at every point at which the main loop accesses data that it shares with them.
//
// The core's own sources and hal/device.hpp run here with crossings, a clock and registers that report every
// access (observed/). The test runs an interrupt before and after each access. Each part of the outcome must
// be one that also occurs if no step of the script happens during the turn: the first steps come before the
// turn, and the others after it.
//
// Both sides also access the following data outside the crossings. It is handed over as follows:
//  - FrameQueue::frames_: the waiting frame belongs to the main loop from `completed_` to `dropped_`;
//  - Uart::rest_, a HandedToInterrupt: it belongs to the main loop until `begun_`, to the interrupts until
//    `ended_`;
//  - Uart::bit_ and character_: `open` writes them before the UART may interrupt;
//  - Receiver::protocol_, DconAssembler::checksum_, RtuAssembler::timing_: `listen` writes them before
//    `open`;
//  - InputEdges::levels_: `begin` writes them before interrupts are enabled;
//  - the driver's pin: both sides write it through the mask in the address, which needs no read.
// Only the main loop uses EventTally::collected_; the interrupt only writes `total_`.
//
// Time passes as on a line: a byte takes 87 us even if it arrives in the middle of a turn, so interrupts may
// delay a turn by milliseconds.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>
#include <set>

#include "firmware/line/event_tally.hpp"
#include "sim/play/modbus_frame.hpp"
#include "tests/firmware/interleaving/scenario.hpp"

namespace ex9000::interleaving {
namespace {

/// Counts the points and interleavings that a test has tried, so that the test can require a minimum.
struct Tried {
  unsigned points = 0;
  unsigned interleavings = 0;

  void print() const { std::printf("points: %u, interleavings: %u\n", points, interleavings); }
};

std::string rtu(std::vector<std::uint8_t> frame) {
  frame = with_crc(std::move(frame));
  return {frame.begin(), frame.end()};
}

void as_made(Settings& /*settings*/) {}
void watched(Settings& settings) {
  settings.watchdog_enabled = true;
  settings.watchdog_timeout = 1;
}

void filtered(Settings& settings) {
  settings.input_filters.set(0, 1);
  settings.input_filters.set(1, 1);
}

// --- events ---

void nothing(Bench& /*bench*/) {}
void silence(Bench& bench) { bench.silence(); }
void tick(Bench& bench) { bench.tick(); }
void memory_done(Bench& bench) { bench.memory_done(); }
void reply_leaves(Bench& bench) { bench.reply_leaves(); }
void reply_byte_leaves(Bench& bench) { bench.reply_byte_leaves(); }
Step edge(unsigned channel, bool level) {
  return [=](Bench& bench) { bench.edge(channel, level); };
}
/// Returns steps that send a request byte by byte, and the silence after it.
std::vector<Step> frame(const std::string& request, const std::string& reply) {
  std::vector<Step> steps;
  for (std::size_t i = 0; i < request.size(); ++i) {
    steps.push_back([=](Bench& bench) {
      bench.byte(static_cast<std::uint8_t>(request[i]));
      if (i + 1 == request.size()) {
        bench.is_asked(reply);
      }
    });
  }
  steps.push_back(silence);
  return steps;
}
std::vector<Step> operator+(std::vector<Step> steps, const std::vector<Step>& more) {
  steps.insert(steps.end(), more.begin(), more.end());
  return steps;
}

using Parts = std::vector<std::string>;

Parts outputs_and_name(Bench& bench) {
  const Settings& settings = bench.module().state().settings;
  return {"outputs " + std::to_string(bench.hardware().outputs) + " name " +
          std::string(settings.name.bytes().begin(), settings.name.bytes().end())};
}
/// Returns one part for each channel, because the order of edges on different channels is not defined: a
/// command may see an edge on one channel, but not an earlier edge on another channel.
Parts inputs(Bench& bench) {
  const ex9000::Inputs& inputs = bench.module().state().inputs;
  Parts parts;
  for (unsigned channel = 0; channel < 2; ++channel) {
    const auto bit = [channel](unsigned channels) { return std::to_string(channels >> channel & 1U); };
    parts.push_back("channel " + std::to_string(channel) + " counter " +
                    std::to_string(inputs.counter(channel)) + " level " + bit(inputs.levels()) + " latches " +
                    bit(inputs.latched_high()) + bit(inputs.latched_low()));
  }
  return parts;
}
/// Returns the inputs after their filters have settled.
Parts settled_inputs(Bench& bench) {
  bench.rest(milliseconds(3));
  return inputs(bench);
}
/// Requires that a timed output has been switched off.
Parts switched_off(Bench& bench) {
  bench.rest(milliseconds(2));
  require(bench.hardware().outputs == 0, "a timed output stays on");
  return outputs_and_name(bench);
}
Parts no_matter(Bench& /*bench*/) { return {}; }
/// Checks to 3 microseconds that the host OK, and nothing else, has restarted the watchdog.
Parts restarted(Bench& bench) {
  const std::uint32_t expires = bench.asked.at("host OK") + 100'000;
  const auto timed_out = [&] { return bench.module().state().settings.timeout_status; };
  require(!timed_out(), "timed out at once");
  bench.pass_time_until(expires);
  bench.whole_turn();
  require(!timed_out(), "a host OK was lost");
  bench.pass_time_until(expires + 3);
  bench.whole_turn();
  require(timed_out(), "a host OK was counted twice, or too late");
  bench.rest(milliseconds(10));  // the timeout is being stored
  return {};
}

/// Does the same for Modbus: a host OK counts from the end of its silence.
Parts modbus_restarted(Bench& bench) {
  bench.asked["host OK"] += LineTiming::at(115200, LineFormat::k8N1).rtu_silence.microseconds();
  return restarted(bench);
}

// --- orders of events ---

class Interleaver {
 public:
  Interleaver(const Scenario& scenario, Tried& counted)
      : scenario_(scenario), counted_(counted), steps_(scenario.script.size()) {
    // Collects the permitted outcomes: those that occur if the first steps come before the turn and the
    // others after it.
    for (std::size_t before = 0; before <= steps_; ++before) {
      Places places(steps_, kAfterTheTurn);
      std::fill_n(places.begin(), before, kBeforeTheTurn);
      const Run run = tried(places);
      outcomes_.resize(std::max(outcomes_.size(), run.outcome.size()));
      for (std::size_t part = 0; part < run.outcome.size(); ++part) {
        outcomes_[part].insert(run.outcome[part]);
      }
      points_ = std::max(points_, run.points);
    }
  }

  /// For each point, tries all steps at this point, and then one step each at this point and at the points
  /// after it.
  void at_every_point() {
    for (int point = 0; point < static_cast<int>(points_); ++point) {
      check(Places(steps_, point));
      if (steps_ > 1) {
        Places places;
        for (std::size_t i = 0; i < steps_; ++i) {
          places.push_back(point + static_cast<int>(i));
        }
        check(places);
      }
    }
    counted_.points += points_;
  }

  /// Tries random pairs of points: some steps at one point, the others at another.
  void at_pairs(std::mt19937& random, unsigned samples) {
    std::uniform_int_distribution<int> any_point(kBeforeTheTurn, static_cast<int>(points_));
    std::uniform_int_distribution<std::size_t> any_step(1, steps_ - 1);
    for (unsigned i = 0; i < samples && steps_ > 1; ++i) {
      const int first = any_point(random);
      const int second = any_point(random);
      Places places(steps_, std::max(first, second));
      std::fill_n(places.begin(), any_step(random), std::min(first, second));
      check(places);
    }
  }

  /// Tries all pairs of points. The script must have two steps.
  void at_all_pairs() {
    for (int first = 0; first < static_cast<int>(points_); ++first) {
      for (int second = first; second < static_cast<int>(points_); ++second) {
        check({first, second});
      }
    }
  }

 private:
  Run tried(const Places& places) {
    ++counted_.interleavings;
    try {
      return play(scenario_, places);
    } catch (const std::logic_error& error) {
      complain(error.what(), places);
      return {};
    }
  }
  void check(const Places& places) {
    const Run run = tried(places);
    for (std::size_t part = 0; part < run.outcome.size(); ++part) {
      if (outcomes_[part].count(run.outcome[part]) == 0) {
        complain("unexpected outcome: " + run.outcome[part], places);
      }
    }
  }
  void complain(const std::string& what, const Places& places) {
    constexpr unsigned kEnough = 3;
    if (complaints_++ < kEnough) {
      std::string at;
      for (const int place : places) {
        at += " " + std::to_string(place);
      }
      ADD_FAILURE() << scenario_.name << ", at" << at << ": " << what;
    }
  }

  const Scenario& scenario_;
  Tried& counted_;
  std::size_t steps_;
  unsigned points_ = 0;
  unsigned complaints_ = 0;
  std::vector<std::set<std::string>> outcomes_;
};

// --- scenarios ---

constexpr std::uint32_t kDconTurnAround = 87;
constexpr std::uint32_t kRtuTurnAround = 1750;

const std::string kRtuOn = rtu({1, 0x05, 0, 2, 0xFF, 0});
const std::string kRtuRead = rtu({1, 0x01, 0, 0, 0, 13});
const std::string kRtuReadReply = rtu({1, 0x01, 2, 0, 0});
const std::string kRtuReadOnReply = rtu({1, 0x01, 2, 4, 0});
const std::string kRtuStore = rtu({1, 0x06, 1, 0xE5, 0, 9});
const std::string kRtuHostOk = rtu({1, 0x03, 0x30, 0x38, 0, 0});
const std::string kRtuProbe = rtu({1, 0x46, 0});
const std::string kRtuProbeReply = rtu({1, 0x46, 0, 0, 0x90, 0x42, 0});

Scenario dcon(const char* name, Step before, std::vector<Step> script,
              std::vector<std::vector<std::string>> replies, std::function<Parts(Bench&)> comes_to) {
  return {name,
          "EX9055D",
          as_made,
          std::move(before),
          std::move(script),
          std::move(replies),
          std::move(comes_to),
          "$01F\r",
          "!01D01.00\r",
          kDconTurnAround};
}
Scenario modbus(const char* name, Step before, std::vector<Step> script,
                std::vector<std::vector<std::string>> replies, std::function<Parts(Bench&)> comes_to) {
  return {name,
          "EX9042D-M",
          as_made,
          std::move(before),
          std::move(script),
          std::move(replies),
          std::move(comes_to),
          kRtuProbe,
          kRtuProbeReply,
          kRtuTurnAround};
}
Scenario with_watchdog(Scenario scenario) {
  scenario.settings = watched;
  return scenario;
}
Scenario with_filters(Scenario scenario) {
  scenario.settings = filtered;
  return scenario;
}
Scenario restless(Scenario scenario) {
  scenario.restless = true;
  return scenario;
}

Step asked(const std::string& request, const std::string& reply) {
  return [=](Bench& bench) {
    bench.asks(request, reply);
    bench.silence();
  };
}
/// Prepares a turn that begins while a store is in progress.
Step storing(const std::string& request, const std::string& reply) {
  return [=](Bench& bench) {
    bench.asks(request, reply);
    bench.silence();
    bench.whole_turn();
  };
}
/// Prepares a turn that begins while a reply is being sent.
Step replying(const std::string& request, const std::string& reply) { return storing(request, reply); }

/// Prepares a turn that begins `before` the host watchdog expires.
Step until_expiry(Duration before) {
  return [=](Bench& bench) {
    const Duration remaining = bench.module().host_watchdog_expiry().remaining(Time(bench.hardware().now));
    bench.rest(remaining - before);
  };
}

/// Prepares a turn that begins while a reply is being sent and the next request waits.
Step replying_with_one_more(const std::string& request, const std::string& reply, const std::string& next,
                            const std::string& next_reply) {
  return [=](Bench& bench) {
    storing(request, reply)(bench);
    asked(next, next_reply)(bench);
    while (!bench.hardware().driving()) {
      bench.rest(Duration(50));
    }
  };
}

std::vector<Scenario> scenarios() {
  const std::vector<Step> edges{edge(0, true), edge(1, true), edge(0, false), edge(1, false), edge(0, true)};
  const std::vector<Step> dcon_name = frame("$01M\r", "!019055\r");
  const std::vector<Step> rtu_read = frame(kRtuRead, kRtuReadReply);
  std::vector<Scenario> all{
      dcon("a frame while idle", nothing, frame("@0105\r", ">\r"), {{">\r"}}, outputs_and_name),
      dcon("a frame while the one before is answered", asked("$01F\r", "!01D01.00\r"), dcon_name,
           {{"!01D01.00\r", "!019055\r"}, {"!01D01.00\r"}}, outputs_and_name),
      dcon("a frame while the one before is carried out", asked("$015\r", "!011\r"), dcon_name,
           {{"!011\r", "!019055\r"}, {"!011\r"}}, outputs_and_name),
      dcon(
          "a frame after a frame without a reply", [](Bench& bench) { bench.bytes("#**\r"); },
          std::vector<Step>{silence} + dcon_name, {{"!019055\r"}, {}}, outputs_and_name),
      dcon("a frame and the memory while storing", storing("~01ONEW\r", "!01\r"),
           frame("$01M\r", "!01NEW\r") + std::vector<Step>{memory_done}, {{"!01\r", "!01NEW\r"}},
           outputs_and_name),
      dcon("the memory and a frame while storing", storing("~01ONEW\r", "!01\r"),
           std::vector<Step>{memory_done, memory_done, memory_done} + frame("$01M\r", "!01NEW\r"),
           {{"!01\r", "!01NEW\r"}, {"!01\r"}}, outputs_and_name),
      dcon("a reply leaves while it is begun", asked("$01M\r", "!019055\r"),
           {reply_byte_leaves, reply_byte_leaves, tick, reply_leaves, tick}, {{"!019055\r"}},
           outputs_and_name),
      dcon("a reply leaves, and the next request", replying("$01M\r", "!019055\r"),
           std::vector<Step>{reply_leaves} + frame("@0103\r", ">\r"), {{"!019055\r", ">\r"}},
           outputs_and_name),
      restless(dcon("the line falls silent with a request waiting",
                    replying_with_one_more("~01ONEW\r", "!01\r", "$01M\r", "!01NEW\r"), {reply_leaves},
                    {{"!01\r", "!01NEW\r"}}, outputs_and_name)),
      dcon("edges while idle", nothing, edges, {{}}, inputs),
      with_filters(dcon("edges on filtered inputs", nothing, edges, {{}}, settled_inputs)),
      with_filters(dcon("edges on filtered inputs while a counter is read", asked("#010\r", ""), edges,
                        {{"!0100000\r"}}, settled_inputs)),
      dcon("a frame while register 0x0251 is stored", storing("~01X02510001\r", "!01\r"),
           frame("$01M\r", "!019055\r") + std::vector<Step>{memory_done}, {{"!01\r", "!019055\r"}},
           outputs_and_name),
      dcon(
          "a frame while a timed output ends",
          [](Bench& bench) {
            bench.asks("~01X02800001\r", "!01\r");
            bench.silence();
            bench.rest(milliseconds(100));
          },
          frame("$01M\r", "!019055\r"), {{"!01\r", "!019055\r"}}, switched_off),
      dcon("edges while a counter is read", asked("#010\r", ""), edges, {{"!0100000\r"}, {"!0100001\r"}},
           inputs),
      dcon("edges while latches are cleared", asked("$01C\r", "!01\r"), edges, {{"!01\r"}}, inputs),
      dcon("edges while a counter is cleared", asked("$01C0\r", "!01\r"), edges, {{"!01\r"}}, inputs),
      dcon("edges while storing", storing("~01ONEW\r", "!01\r"), edges + std::vector<Step>{memory_done},
           {{"!01\r"}}, inputs),
      dcon("ticks while idle", nothing, {tick, tick}, {{}}, outputs_and_name),
      with_watchdog(dcon("two host OKs, one before and one after the expiry", until_expiry(Duration(500)),
                         frame("~**\r", "host OK") + frame("~**\r", "host OK"), {{}}, restarted)),
      with_watchdog(dcon("host OK while idle", nothing, frame("~**\r", "host OK"), {{}}, restarted)),
      with_watchdog(dcon("host OK after a frame without a reply", asked("#**\r", ""),
                         frame("~**\r", "host OK"), {{}}, restarted)),
      with_watchdog(dcon("host OK after a frame", asked("$01M\r", "!019055\r"), frame("~**\r", "host OK"),
                         {{"!019055\r"}}, no_matter)),
      with_watchdog(dcon(
          "host OK while storing, the queue full",
          [](Bench& bench) {
            storing("~01ONEW\r", "!01\r")(bench);
            bench.asks("$01M\r", "!01NEW\r");
          },
          frame("~**\r", "host OK"), {{"!01\r", "!01NEW\r"}}, restarted)),

      modbus("a Modbus frame while idle", nothing, frame(kRtuOn, kRtuOn), {{kRtuOn}}, outputs_and_name),
      modbus("a Modbus frame while the one before is answered", asked(kRtuOn, kRtuOn),
             frame(kRtuRead, kRtuReadOnReply), {{kRtuOn, kRtuReadOnReply}, {kRtuOn}}, outputs_and_name),
      modbus("a Modbus frame while storing", storing(kRtuStore, kRtuStore),
             rtu_read + std::vector<Step>{memory_done}, {{kRtuStore, kRtuReadReply}}, outputs_and_name),
      modbus("a Modbus reply leaves, and the next request", replying(kRtuOn, kRtuOn),
             std::vector<Step>{reply_leaves} + frame(kRtuRead, kRtuReadOnReply), {{kRtuOn, kRtuReadOnReply}},
             outputs_and_name),
      restless(modbus("the Modbus line falls silent with a request waiting",
                      replying_with_one_more(kRtuStore, kRtuStore, kRtuRead, kRtuReadReply), {reply_leaves},
                      {{kRtuStore, kRtuReadReply}}, outputs_and_name)),
      with_watchdog(
          modbus("Modbus host OK while idle", nothing, frame(kRtuHostOk, "host OK"), {{}}, modbus_restarted)),
      with_watchdog(modbus(
          "Modbus host OK while storing, the queue full",
          [](Bench& bench) {
            storing(kRtuStore, kRtuStore)(bench);
            bench.asks(kRtuRead, kRtuReadReply);
            bench.silence();
          },
          frame(kRtuHostOk, "host OK"), {{kRtuStore, kRtuReadReply}}, modbus_restarted)),
  };
  Scenario counted = modbus("edges while Modbus reads a counter", asked(rtu({1, 0x03, 0, 0, 0, 1}), ""),
                            edges, {{rtu({1, 0x03, 2, 0, 0})}, {rtu({1, 0x03, 2, 0, 1})}}, inputs);
  counted.model = "EX9052D-M";
  counted.probe_reply = rtu({1, 0x46, 0, 0, 0x90, 0x52, 0});
  all.push_back(counted);
  return all;
}

TEST(Interleaving, AnInterruptAtAnyPointHasAPermittedOutcome) {
  Tried all;
  for (const Scenario& scenario : scenarios()) {
    Interleaver(scenario, all).at_every_point();
  }
  all.print();
  EXPECT_GT(all.points, 900U);
  EXPECT_GT(all.interleavings, 2000U);
}

TEST(Interleaving, InterruptsAtRandomPairsOfPointsHaveAPermittedOutcome) {
  std::mt19937 random(20261121);  // NOLINT(cert-msc51-cpp): the same pairs each time
  Tried all;
  for (const Scenario& scenario : scenarios()) {
    Interleaver(scenario, all).at_pairs(random, 200);
  }
  all.print();
  EXPECT_GT(all.interleavings, 4000U);
}

TEST(Interleaving, ASilenceBelongsToTheFrameBeforeIt) {
  // The silence after a frame without a reply ends while the frame is processed, and the next frame arrives
  // while that silence is not yet processed.
  Scenario scenario = dcon(
      "a silence, and one more frame", [](Bench& bench) { bench.bytes("#**\r"); },
      {silence, [](Bench& bench) { bench.asks("$01M\r", "!019055\r"); }}, {{"!019055\r"}, {}}, no_matter);
  Tried all;
  Interleaver(scenario, all).at_all_pairs();
  all.print();
  EXPECT_GT(all.interleavings, 200U);
}

/// Sends a whole frame at each point of the turn that answers an earlier frame. The new frame must not be
/// lost from the point at which the earlier frame has been processed until the driver is switched on.
void expect_one_more_is_kept(Scenario scenario, const std::string& request, const std::string& reply) {
  bool driving = false;
  std::size_t answered = 0;
  scenario.script = {[&](Bench& bench) {
    driving = bench.takes_bytes_for_its_echo();
    bench.asks(request, reply);
    bench.silence();
  }};
  scenario.comes_to = [&](Bench& bench) {
    answered = bench.hardware().sent.size();
    return Parts();
  };
  const int points = static_cast<int>(play(scenario, {kAfterTheTurn}).points);
  EXPECT_GT(points, 10) << scenario.name;
  bool judged = false;
  int kept = 0;
  for (int point = 0; point < points; ++point) {
    play(scenario, {point});
    judged |= answered == 2;
    kept += answered == 2 ? 1 : 0;
    EXPECT_TRUE(answered == 2 || !judged || driving) << scenario.name << ", at " << point;
    EXPECT_FALSE(answered == 2 && driving) << scenario.name << ", at " << point;
  }
  EXPECT_GT(kept, 1) << scenario.name;
}

TEST(Interleaving, TheNextFrameIsKeptUntilTheDriverIsSwitchedOn) {
  expect_one_more_is_kept(dcon("a frame after one that is answered", asked("$01F\r", "!01D01.00\r"), {},
                               {{"!01D01.00\r", "!019055\r"}, {"!01D01.00\r"}}, no_matter),
                          "$01M\r", "!019055\r");
  expect_one_more_is_kept(dcon("a frame after one that is carried out", asked("$015\r", "!011\r"), {},
                               {{"!011\r", "!019055\r"}, {"!011\r"}}, no_matter),
                          "$01M\r", "!019055\r");
  expect_one_more_is_kept(modbus("a Modbus frame after one that is carried out", asked(kRtuOn, kRtuOn), {},
                                 {{kRtuOn, kRtuReadOnReply}, {kRtuOn}}, no_matter),
                          kRtuRead, kRtuReadOnReply);
}

TEST(Interleaving, AFrameThatEndsWhileTheMainLoopTurnsIsNotAnsweredTooEarly) {
  const Scenario scenario =
      dcon("a CR that is newer than the time of the turn", nothing,
           {[](Bench& bench) { bench.asks("@0105\r", ">\r"); }, silence}, {{">\r"}}, outputs_and_name);
  const int points = static_cast<int>(play(scenario, {kAfterTheTurn, kAfterTheTurn}).points);
  EXPECT_GT(points, 10);
  for (int point = kBeforeTheTurn; point < points; ++point) {
    EXPECT_NO_THROW(play(scenario, {point, kAfterTheTurn})) << point;
  }
}

TEST(Interleaving, ABusMessageCountRequestIsCountedOnceWheneverItsSilenceEnds) {
  const std::string request = rtu({1, 0x08, 0, 0x0B, 0, 0});
  const std::string reply = rtu({1, 0x08, 0, 0x0B, 0, 1});
  const Scenario scenario = modbus(
      "a silence while bus messages are read", [=](Bench& bench) { bench.asks(request, reply); }, {silence},
      {{reply}}, outputs_and_name);
  const int points = static_cast<int>(play(scenario, {kAfterTheTurn}).points);
  EXPECT_GT(points, 10);
  for (int point = kBeforeTheTurn; point < points; ++point) {
    EXPECT_NO_THROW(play(scenario, {point})) << point;
  }
}

// --- checks that the test finds errors ---

TEST(Points, FindACountThatIsReadTwice) {
  unsigned lost = 0;
  unsigned points = 1;
  for (unsigned at = 0; at < points; ++at) {
    WrittenByInterrupt<std::uint32_t> total;
    std::uint32_t seen = 0;
    std::uint32_t fresh = 0;
    points = Points::watch(
        [&](unsigned point) {
          if (point == at) {
            Points::interrupt([&] { total.store_in_interrupt(total.load() + 1); });
          }
        },
        [&] {
          fresh = total.load() - seen;
          seen = total.load();
        });
    lost += total.load() - seen == 0 && fresh == 0 ? 1U : 0U;
  }
  EXPECT_EQ(lost, 2U);  // after the first load, and before the second
}

TEST(Points, FindAHandoverThatIsTorn) {
  HandedToInterrupt<Bytes> handed;
  EXPECT_THROW(Points::watch([&](unsigned) { Points::interrupt([&] { handed.in_interrupt() = {}; }); },
                             [&] { handed.set_in_main_loop({}); }),
               std::logic_error);
}

}  // namespace
}  // namespace ex9000::interleaving
