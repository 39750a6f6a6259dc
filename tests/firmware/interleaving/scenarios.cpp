#include "tests/firmware/interleaving/scenarios.hpp"

#include <cstdint>
#include <utility>

#include "tests/firmware/interleaving/modbus_frames.hpp"
#include "tests/firmware/interleaving/steps.hpp"

namespace ex9000::interleaving {

namespace {

constexpr std::uint32_t kDconTurnAround = 87;
constexpr std::uint32_t kRtuTurnAround = 1750;

void as_made(Settings& /*settings*/) {}

void watched(Settings& settings) {
  settings.watchdog_enabled = true;
  settings.watchdog_timeout = 1;
}

void filtered(Settings& settings) {
  settings.input_filters.set(0, 1);
  settings.input_filters.set(1, 1);
}

Scenario with_watchdog(Scenario scenario) {
  scenario.settings = watched;
  return scenario;
}

Scenario with_filters(Scenario scenario) {
  scenario.settings = filtered;
  return scenario;
}

/// With few zeros, so that there are few bytes FF.
void numbered(Settings& settings) { settings.serial_number = 0x0D00FFFF; }

/// The bytes FF of an arbitration have less time between them than replies: a window without its byte.
Scenario with_number(Scenario scenario) {
  constexpr std::uint32_t kBetweenBursts = 60;
  scenario.settings = numbered;
  scenario.turn_around = kBetweenBursts;
  return scenario;
}

/// The bytes of a request for a round of a scan, then all its windows and the reply.
std::vector<Step> round() {
  std::vector<Step> steps = frame(kScan, "");
  steps.back() = [](Bench& bench) {
    constexpr unsigned kWindows = 32;
    for (unsigned window = 0; window <= kWindows; ++window) {
      silence(bench);
    }
    reply_leaves(bench);
  };
  return steps;
}

/// What the module sends in a round that it wins.
std::vector<std::string> bursts_and_reply() {
  std::vector<std::string> sent(11, "\xFF");
  sent.push_back(kScanReply);
  return sent;
}

std::vector<std::string> after(const std::string& reply) {
  std::vector<std::string> sent = bursts_and_reply();
  sent.insert(sent.begin(), reply);
  return sent;
}

Scenario restless(Scenario scenario) {
  scenario.restless = true;
  return scenario;
}

}  // namespace

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
      dcon("a frame, and then the end of a memory job, during a store", storing("~01ONEW\r", "!01\r"),
           frame("$01M\r", "!01NEW\r") + std::vector<Step>{memory_done}, {{"!01\r", "!01NEW\r"}},
           outputs_and_name),
      dcon("the ends of memory jobs, and then a frame, during a store", storing("~01ONEW\r", "!01\r"),
           std::vector<Step>{memory_done, memory_done, memory_done} + frame("$01M\r", "!01NEW\r"),
           {{"!01\r", "!01NEW\r"}, {"!01\r"}}, outputs_and_name),
      dcon("bytes of a reply are sent while the main loop still starts this reply",
           asked("$01M\r", "!019055\r"), {reply_byte_leaves, reply_byte_leaves, tick, reply_leaves, tick},
           {{"!019055\r"}}, outputs_and_name),
      dcon("a reply ends, and then the next request arrives", replying("$01M\r", "!019055\r"),
           std::vector<Step>{reply_leaves} + frame("@0103\r", ">\r"), {{"!019055\r", ">\r"}},
           outputs_and_name),
      restless(dcon("a reply ends while a request waits",
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
      with_watchdog(dcon("two host OKs, before and after the time at which the watchdog would expire",
                         until_expiry(Duration(500)), frame("~**\r", "host OK") + frame("~**\r", "host OK"),
                         {{}}, restarted)),
      with_watchdog(dcon("host OK while idle", nothing, frame("~**\r", "host OK"), {{}}, restarted)),
      with_watchdog(dcon("host OK after a frame without a reply", asked("#**\r", ""),
                         frame("~**\r", "host OK"), {{}}, restarted)),
      with_watchdog(dcon("host OK after a frame", asked("$01M\r", "!019055\r"), frame("~**\r", "host OK"),
                         {{"!019055\r"}}, no_matter)),
      with_watchdog(dcon(
          "host OK while the module stores and the queue is full",
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
      modbus("a Modbus reply ends, and then the next request arrives", replying(kRtuOn, kRtuOn),
             std::vector<Step>{reply_leaves} + frame(kRtuRead, kRtuReadOnReply), {{kRtuOn, kRtuReadOnReply}},
             outputs_and_name),
      restless(modbus("a Modbus reply ends while a request waits",
                      replying_with_one_more(kRtuStore, kRtuStore, kRtuRead, kRtuReadReply), {reply_leaves},
                      {{kRtuStore, kRtuReadReply}}, outputs_and_name)),
      with_number(modbus("a scan while idle", nothing, round(), {bursts_and_reply()}, outputs_and_name)),
      with_number(modbus("a scan while a frame is answered", asked(kRtuOn, kRtuOn), round(),
                         {{kRtuOn}, after(kRtuOn)}, outputs_and_name)),
      with_number(modbus("a reply ends, and then a scan begins", replying(kRtuOn, kRtuOn),
                         std::vector<Step>{reply_leaves} + round(), {after(kRtuOn)}, outputs_and_name)),
      with_number(modbus("a scan while storing", storing(kRtuStore, kRtuStore),
                         round() + std::vector<Step>{memory_done}, {{kRtuStore}}, outputs_and_name)),
      with_watchdog(
          modbus("Modbus host OK while idle", nothing, frame(kRtuHostOk, "host OK"), {{}}, modbus_restarted)),
      with_watchdog(modbus(
          "Modbus host OK while the module stores and the queue is full",
          [](Bench& bench) {
            storing(kRtuStore, kRtuStore)(bench);
            bench.asks(kRtuRead, kRtuReadReply);
            bench.silence();
          },
          frame(kRtuHostOk, "host OK"), {{kRtuStore, kRtuReadReply}}, modbus_restarted)),
  };
  // In one of these scenarios, the turn ends the store and applies the filter.
  for (unsigned jobs = 0; jobs < 6; ++jobs) {
    all.push_back(dcon("an edge while a filter is switched on",
                       storing_until(jobs, "~01X02400001\r", "!01\r"), {edge(0, true)}, {{"!01\r"}},
                       settled_inputs));
  }
  Scenario counted = modbus("edges while Modbus reads a counter", asked(rtu({1, 0x03, 0, 0, 0, 1}), ""),
                            edges, {{rtu({1, 0x03, 2, 0, 0})}, {rtu({1, 0x03, 2, 0, 1})}}, inputs);
  counted.model = "EX9052D-M";
  counted.probe_reply = rtu({1, 0x46, 0, 0, 0x90, 0x52, 0});
  all.push_back(counted);
  return all;
}

}  // namespace ex9000::interleaving
