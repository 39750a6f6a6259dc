// Tests that nobody can notice the fast paths of the wires: the same random traffic, faults, actions and time
// steps cause the same bytes, drivers, notes, states and tallies at the same times on two lines. On one line
// every module hears alone and every byte has its events; on the other, modules share an ear and undisturbed
// bytes arrive at once.
#include "sim/virtual_line/wires/shared_ear.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <iterator>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/notation/actions.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/values.hpp"
#include "sim/virtual_line/line/line.hpp"
#include "tests/oracles/reference/dcon_check.hpp"
#include "tests/support/environment.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// Writes down everything that happens on a line.
class Watched final : private WireObserver {
 public:
  Watched(const std::vector<ModuleSpec>& modules, LineKind kind, std::uint64_t seed)
      : line_(modules, kind, [this](std::uint8_t byte, ByteStatus status) {
          write("master " + hex_byte_text(byte) + " " + std::to_string(static_cast<int>(status)));
        }) {
    line_.wires().observe(*this);
    line_.configure_faults(seed, [this](const std::string& text) { write(text); });
    line_.come_up();
    line_.master().set_mode(line_.module(0).mode());
    for (std::size_t i = 0; i < line_.size(); ++i) {
      line_.module(i).tell([this, i](const std::string& text) { write(std::to_string(i) + ": " + text); });
    }
  }

  Line& line() { return line_; }
  /// Sends a request through the queue of the line.
  void ask(const std::vector<std::uint8_t>& frame) {
    RequestQueue::Request request;
    request.bytes = frame;
    request.expects_reply = frame[0] != 0;
    request.owner = owner_;
    request.done = [this](const RequestQueue::Reply& reply) {
      write("queue " + hex_text(reply.bytes) + " " + std::to_string(reply.delay.count()));
    };
    line_.requests().ask(std::move(request));
  }
  /// What has happened since the last call, then the state.
  std::string news() {
    write("next " + std::to_string(line_.wires().next().count()) + (line_.pending() ? " pending" : ""));
    for (std::size_t i = 0; i < line_.size(); ++i) {
      const SimulatedModule& module = line_.module(i);
      write(std::to_string(i) + ": " + hex_word_text(module.outputs()) +
            (module.led_lit() ? " lit" : " dark") + " resets " + std::to_string(module.watchdog_resets()));
    }
    return std::exchange(log_, "");
  }

 private:
  void driver(std::size_t station, bool on, VirtualTime /*now*/) override {
    write(std::to_string(station) + (on ? " drives" : " releases"));
  }
  void changed(std::size_t station, Levels arrives) override {
    write(std::to_string(station) + " arrives as " + std::to_string(arrives));
  }
  void byte(std::size_t station, std::uint8_t byte, SerialMode /*mode*/, bool collided, VirtualTime start,
            VirtualTime end) override {
    ++bytes;
    write(std::to_string(station) + " sent " + hex_byte_text(byte) + (collided ? " collided " : " ") +
          std::to_string(start.count()) + " " + std::to_string(end.count()));
  }
  void write(const std::string& text) {
    log_ += std::to_string(line_.clock().virtual_now().count()) + " " + text + "\n";
  }

  std::string log_;
  std::shared_ptr<int> owner_ = std::make_shared<int>(0);
  Line line_;

 public:
  std::uint64_t bytes = 0;
};

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  unsigned below(unsigned limit) { return static_cast<unsigned>(engine_() % limit); }
  bool once_in(unsigned times) { return below(times) == 0; }
  std::uint8_t byte() { return static_cast<std::uint8_t>(engine_()); }
  template <class Container>
  auto pick(const Container& container) {
    return container[below(static_cast<unsigned>(container.size()))];
  }

 private:
  std::mt19937_64 engine_;
};

using Frame = std::vector<std::uint8_t>;

/// A plant in two copies, which get the same actions.
class Plants {
 public:
  explicit Plants(std::uint64_t seed) : random_(seed) {
    const LineKind kind = random_.pick(std::vector<LineKind>{kPaced, kPaced, kStrictlyPaced, kInstant});
    std::vector<ModuleSpec> modules;
    const unsigned rates = random_.once_in(3) ? 2 : 1;
    for (unsigned count = 3 + random_.below(8); count != 0; --count) {
      modules.push_back(module(rates));
      specs_ += (specs_.empty() ? "" : " ") + std::string(modules.back().model->designation) + "@" +
                hex_byte_text(modules.back().settings.address);
    }
    for (const std::size_t fewest : {std::numeric_limits<std::size_t>::max(), std::size_t{2}}) {
      LineKind each = kind;
      each.fewest_to_share = fewest;
      plants_.push_back(std::make_unique<Watched>(modules, each, seed));
    }
  }

  /// Carries out one action. Returns how the two copies differ after it; empty if they do not.
  std::string step() {
    const std::string what = act();
    done_ += what + "\n";
    return difference();
  }

  /// Returns how the tallies of the copies differ, as the modules report them; empty if they do not.
  std::string tallies() {
    for (std::size_t i = 0; i < plants_[0]->line().size(); ++i) {
      const SimulatedModule& module = plants_[0]->line().module(i);
      if (!module.powered() || !module.module().listening()) {
        continue;
      }
      const InForce in_force = module.module().state().in_force;
      for (Watched* each : {plants_[0].get(), plants_[1].get()}) {
        each->line().faults().remove_all();
        each->line().master().set_mode(each->line().module(i).mode());
      }
      pass(std::chrono::seconds(1));
      for (unsigned tally = 0; tally < (in_force.protocol == Protocol::ModbusRtu ? 1 : 8); ++tally) {
        send(in_force.protocol == Protocol::ModbusRtu
                 ? with_crc({in_force.address, 0x04, 0x03, 0x08, 0x00, 0x08})
                 : dcon("~" + hex_byte_text(in_force.address) + "X030" + "89ABCDEF"[tally], in_force));
        pass(milliseconds(300));
        if (const std::string how = difference(); !how.empty()) {
          return "the tallies of module " + std::to_string(i) + " differ\n" + how;
        }
      }
    }
    return "";
  }

  [[nodiscard]] std::uint64_t bytes() const { return plants_[0]->bytes; }

 private:
  ModuleSpec module(unsigned rates) {
    ModuleSpec spec = factory_fresh(kModels[random_.below(static_cast<unsigned>(std::size(kModels)))]);
    const auto take = [&](const std::string& key, const std::string& value) {
      take_module_setting(spec, key, "", value);
    };
    const bool odd = !alike_ || random_.once_in(6);
    const bool modbus = spec.model->speaks_modbus() && (odd ? !random_.once_in(3) : modbus_);
    take("protocol", modbus ? "modbus" : "ascii");
    take("address", hex_byte_text(1 + random_.below(12)));
    take("baud", rates == 1 || random_.once_in(2) ? "38400" : "9600");
    take("format", odd ? random_.pick(std::vector<std::string>{"8N1", "8N2", "8E1"}) : format_);
    take("checksum", (odd ? random_.once_in(3) : checksum_) ? "on" : "off");
    spec.settings.watchdog_enabled = random_.once_in(2);
    spec.settings.watchdog_timeout = 3;  // 0.3 s
    spec.settings.safe_value = spec.model->has_outputs() ? 0x0A : 0;
    return spec;
  }

  std::string difference() {
    const std::string alone = plants_[0]->news();
    const std::string shared = plants_[1]->news();
    if (alone == shared) {
      return "";
    }
    std::size_t differs = 0;
    while (alone[differs] == shared[differs]) {
      ++differs;
    }
    const std::size_t begin = alone.rfind('\n', differs) + 1;
    return specs_ + "\n" + done_ + "alone:  " + alone.substr(begin, 200) +
           "\nshared: " + shared.substr(begin, 200);
  }

  template <class Do>
  void both(Do action) {
    for (const auto& each : plants_) {
      action(each->line());
    }
  }
  void pass(VirtualTime time) {
    Wires& slow = plants_[0]->line().wires();
    const VirtualTime until = slow.clock().virtual_now() + time;
    while (slow.next() <= until) {
      slow.run_until(slow.next());
    }
    both([&](Line& line) { line.wires().run_until(until); });
  }
  void send(const Frame& frame) {
    both([&](Line& line) { line.master().send(frame.data(), frame.size()); });
  }

  static Frame dcon(const std::string& text, const InForce& in_force) {
    const std::string whole = text + (in_force.checksum ? reference::check_of(text) : "") + "\r";
    return {whole.begin(), whole.end()};
  }

  std::size_t any_module() { return random_.below(static_cast<unsigned>(plants_[0]->line().size())); }

  Frame modbus_frame() {
    const std::uint8_t address = random_.once_in(8) ? 0 : static_cast<std::uint8_t>(1 + random_.below(13));
    const auto low = static_cast<std::uint8_t>(random_.below(9));
    switch (random_.below(9)) {
      case 8:
        return with_crc({address, 0x04, 0x30, 0x38, 0x00, 0x00});  // host OK
      case 0:
        return with_crc({address, 0x05, 0x00, low, 0xFF, 0x00});
      case 1:
        return with_crc({address, 0x0F, 0x00, 0x00, 0x00, 0x08, 0x01, random_.byte()});
      case 2:
        return with_crc({address, 0x06, 0x02, 0x00, 0x00, low});
      case 3:
        return with_crc({address, 0x08, 0x00, 0x0A, 0x00, 0x00});
      case 4:
        return with_crc({address, 0x81, 0x02});
      default:
        return with_crc({address, 0x01, 0x00, 0x00, 0x00, 0x08});
    }
  }

  Frame dcon_frame() {
    const std::string address = random_.once_in(8) ? "**" : hex_byte_text(1 + random_.below(13));
    const std::string lead = random_.pick(std::vector<std::string>{"$", "#", "%", "@", "~", "!", ">", "?"});
    const std::string body = random_.pick(
        std::vector<std::string>{"", "M", "6", "2", "F", "5", "00AA", "0105", "5S", "3105", "OABC"});
    InForce in_force;
    in_force.checksum = alike_ && !random_.once_in(8) ? checksum_ : random_.once_in(3);
    Frame frame = dcon(random_.once_in(5)   ? "~**"
                       : random_.once_in(8) ? lead + address + std::string(25 + random_.below(10), 'A')
                                            : lead + address + body,
                       in_force);
    if (random_.once_in(6)) {
      frame.insert(frame.begin(), 1 + random_.below(40),
                   random_.pick(std::vector<std::uint8_t>{0, '\n', 'x', '$'}));
    }
    return frame;
  }

  Frame garbage() {
    Frame frame;
    for (unsigned count = 1 + random_.below(random_.once_in(10) ? 900 : 30); count != 0; --count) {
      frame.push_back(random_.byte());
    }
    return frame;
  }

  /// Returns what was done.
  std::string act() {
    switch (random_.below(16)) {
      case 0:
        return command(std::to_string(any_module() + 1) + " " +
                       random_.pick(std::vector<std::string>{"power off", "power on", "power on", "reset",
                                                             "init on", "init off", "hang", "input 0 on",
                                                             "input 0 off", "pulse 1 x3"}));
      case 1:
        return command(std::to_string(any_module() + 1) + " fault " +
                       random_.pick(std::vector<std::string>{
                           "late-reply 30ms", "late-driver 3ms every 2nd reply",
                           "lost-reply with probability 0.3", "wrong-rate 9600 for 3s",
                           "wrong-rate 38400 for 3s", "gone for 300ms", "power-cut after 2 writes", "hang",
                           "exception 04 every 2nd reply", "wrong-unit 05 every 2nd reply"}));
      case 2:
        return command(random_.pick(std::vector<std::string>{
            "fault bit-errors 0.002 for 500ms", "fault lost-bytes 0.02 for 500ms",
            "fault inserted-bytes 0.02 for 500ms", "fault echo 3ms for 300ms",
            "fault foreign-traffic 0501000000083C48", "fault foreign-traffic 2430314D0D", "fault off all",
            "fault off all", "baud 9600", "baud 38400", "format 8N1", "format 8E1"}));
      case 3: {
        const VirtualTime time = milliseconds(random_.once_in(4) ? 30'000 : random_.below(400));
        pass(time);
        return "wait " + std::to_string(time.count());
      }
      case 4:
        return ask(modbus_frame());
      default:
        break;
    }
    Frame frame = random_.once_in(12) ? garbage() : random_.once_in(2) ? modbus_frame() : dcon_frame();
    if (random_.once_in(10)) {
      frame.resize(1 + random_.below(static_cast<unsigned>(frame.size())));
    }
    if (random_.once_in(10)) {
      frame.insert(frame.begin(), 0);
    }
    if (random_.once_in(4)) {
      return in_pieces(frame);
    }
    const VirtualTime time =
        microseconds(random_.once_in(3) ? random_.below(8000) : 20'000 + random_.below(40'000));
    // The first byte may end at the very time at which a silence ends.
    const VirtualTime next = random_.once_in(4) ? plants_[0]->line().wires().next() : VirtualTime(0);
    const VirtualTime at = next == kNever ? VirtualTime(0) : next - plants_[0]->line().master().takes(1);
    both([&](Line& line) { line.master().send(frame.data(), frame.size(), at); });
    pass(time);
    return "send " + hex_text(frame) + " at " + std::to_string(at.count()) + ", wait " +
           std::to_string(time.count());
  }

  /// Sends a frame with pauses that may or may not end it.
  std::string in_pieces(Frame frame) {
    std::string what = "pieces";
    while (!frame.empty()) {
      const unsigned bytes = random_.once_in(2) ? 1 : 1 + random_.below(static_cast<unsigned>(frame.size()));
      const auto size = static_cast<std::ptrdiff_t>(bytes);
      const Frame piece(frame.begin(), frame.begin() + size);
      frame.erase(frame.begin(), frame.begin() + size);
      send(piece);
      const Line& line = plants_[0]->line();
      const VirtualTime byte = line.master().takes(1);
      const auto part_of = [&](VirtualTime time) {
        return VirtualTime(random_.below(static_cast<unsigned>(time.count()) + 1));
      };
      const VirtualTime pause = random_.pick(
          std::vector<VirtualTime>{VirtualTime(0), line.rtu_silence(), line.rtu_silence() / 2,
                                   line.rtu_separate(), part_of(line.rtu_separate()),
                                   line.rtu_silence() - std::min(byte, line.rtu_silence()) + part_of(byte)});
      pass(line.master().takes(piece.size()) + pause);
      what += " " + hex_text(piece) + " +" + std::to_string(pause.count());
    }
    return what;
  }

  std::string ask(const Frame& frame) {
    for (const auto& each : plants_) {
      each->ask(frame);
    }
    return "ask " + hex_text(frame);
  }

  std::string command(const std::string& text) {
    std::string outcome = text;
    both([&](Line& line) {
      try {
        static_cast<void>(sim::act({{"", line}}, words_of(text)));
      } catch (const std::invalid_argument&) {
        outcome = text + ": refused";
      }
    });
    return outcome;
  }

  Random random_;
  // Most plants have modules with equal settings, which share an ear.
  bool alike_ = !random_.once_in(4);
  bool modbus_ = random_.once_in(2);
  bool checksum_ = random_.once_in(3);
  std::string format_ = random_.pick(std::vector<std::string>{"8N1", "8N2", "8E1"});
  std::string specs_;
  std::string done_;
  std::vector<std::unique_ptr<Watched>> plants_;
};

TEST(SharedEar, ATurnAroundByteAndAPauseMayPrecedeAFrame) {
  std::vector<ModuleSpec> modules;
  for (const char* module : {"EX9042D-M@01", "EX9042D-M@02", "EX9042D-M@03", "EX9042D-M@04"}) {
    modules.push_back(parse_module_spec(module));
  }
  const Frame switches_on = with_crc({1, 0x05, 0x00, 0x00, 0xFF, 0x00});
  unsigned replies = 0;
  for (VirtualTime pause{0}; pause < milliseconds(6); pause += microseconds(100)) {
    std::vector<std::uint16_t> outputs;
    for (const std::size_t fewest : {std::numeric_limits<std::size_t>::max(), std::size_t{2}}) {
      LineKind kind = kPaced;
      kind.fewest_to_share = fewest;
      Watched watched(modules, kind, 1);
      Line& line = watched.line();
      line.wires().run_for(milliseconds(10));
      const std::uint8_t turn_around = 0;
      line.master().send(&turn_around, 1);
      line.wires().run_for(line.master().takes(1) + pause);
      line.master().send(switches_on.data(), switches_on.size());
      line.wires().run_for(milliseconds(100));
      outputs.push_back(line.module(0).outputs());
    }
    EXPECT_EQ(outputs[0], outputs[1]) << "pause " << pause.count();
    replies += outputs[1];
  }
  EXPECT_GT(replies, 0U);
}

TEST(FastPaths, NobodyNoticesThem) {
  const std::uint64_t plants = number_in_environment("EX9000_PLANTS", 40);
  const std::uint64_t first = number_in_environment("EX9000_SEED", 1);
  std::uint64_t bytes = 0;
  for (std::uint64_t seed = first; seed < first + plants; ++seed) {
    Plants both(seed);
    for (int step = 0; step < 120; ++step) {
      ASSERT_EQ(both.step(), "") << "seed " << seed << ", step " << step;
    }
    ASSERT_EQ(both.tallies(), "") << "seed " << seed;
    bytes += both.bytes();
  }
  std::printf("%llu plants, %llu bytes\n", static_cast<unsigned long long>(plants),
              static_cast<unsigned long long>(bytes));
}

}  // namespace
}  // namespace ex9000::sim
