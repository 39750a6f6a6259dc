// Connects a module to a witness (tests/oracles/judges/witness.hpp). The witness receives the same bytes as
// the module, and decides independently which replies and which changes of outputs and settings are
// permitted.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "firmware/model/baud.hpp"
#include "firmware/model/model.hpp"
#include "tests/fuzz/lean_module.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/oracles/judges/checks.hpp"
#include "tests/oracles/judges/module_state.hpp"
#include "tests/oracles/judges/witness.hpp"

namespace ex9000::fuzz {

using judges::are_digits_of;
using judges::crc16;
using judges::dcon_sum;
using judges::upper_hex;

/// Aborts if the witness reports an error. Also aborts if the outputs do not start with the power-on value,
/// or with the safe value after a timeout. The witness takes only two things from the module without a
/// check: the settings in force after a reset, and the values with which the module starts.
class Session final : public ModuleObserver {
 public:
  Session(const Model& model, bool strict_gaps)
      : strict_gaps_(strict_gaps),
        module_(model, *this, strict_gaps ? LineTiming::strictly_at : LineTiming::at),
        witness_(model, [](const char* claim) { require(false, claim); }) {}
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  LeanModule& module() { return module_; }
  Surroundings& around() { return module_.around(); }
  /// Returns whether the module uses Modbus. The protocol changes only at a reset.
  [[nodiscard]] bool speaks_modbus() const { return witness_.hears_modbus(); }
  [[nodiscard]] const InForce& in_force() const { return state().in_force; }
  /// Returns T3.5 in microseconds. In ASCII the function returns a value too, but T3.5 has no meaning there.
  [[nodiscard]] Microseconds silence() const { return witness_.silence(); }

  void reset() {
    held_until_ = kNever;
    const Microseconds began = module_.now();
    booting_ = true;
    outputs_ = 0;
    module_.reset();
    booting_ = false;
    const judges::Values came_up = values();
    require(outputs_ == (came_up.timed_out ? came_up.safe : came_up.power_on),
            "outputs start with the power-on value, or with the safe value after a timeout");
    judges::Listening listening = judges::listening_of(state());
    listening.strict_gaps = strict_gaps_;
    witness_.comes_up(listening, came_up, began);
  }

  void wait(Microseconds time) { advance_to(module_.now() + time); }
  /// Stops the main loop for `time`, which begins now. Returns immediately.
  void hold(Microseconds time) {
    witness_.is_held(true, module_.now());
    held_until_ = module_.now() + time;
    module_.hold(true);
  }
  void toggle_input(unsigned channel) { module_.toggle_input(channel); }
  void tick() { module_.tick(); }

  /// Waits for `gap` and then sends a byte. Waits a little longer if rounding of `gap` to microseconds could
  /// change whether the gap ends or spoils a frame. Drops the byte if the module is sending when the byte
  /// ends.
  void byte(std::uint8_t byte, ByteStatus status, Microseconds gap = 0) {
    const Microseconds end = witness_.beyond_doubt(module_.now() + gap + witness_.character());
    advance_to(end);
    if (module_.sending()) {
      return;  // the module does not receive while it sends, because it would receive its own reply
    }
    witness_.hears(byte, status == ByteStatus::Good, in_force().address, end);
    module_.receive(byte, status);
  }

  /// Repeats a wait of 250 ms until the module is not sending at the end of the wait.
  void wait_for_quiet() {
    do {
      wait(250 * kMillisecond);
    } while (module_.sending());
  }

  /// Sends `request`. In Modbus, adds the CRC. In ASCII, adds the checksum if it is enabled, and then the
  /// CR. Returns the reply without these additions, or no bytes if there is no reply. Call this only while
  /// the line is quiet. The result is valid until the next reply begins.
  Bytes ask(Bytes request) {
    reply_size_ = 0;
    for (const std::uint8_t each : request) {
      byte(each, ByteStatus::Good);
    }
    if (speaks_modbus()) {
      const std::uint16_t crc = crc16(request.data, request.size);
      byte(static_cast<std::uint8_t>(crc % 256), ByteStatus::Good);
      byte(static_cast<std::uint8_t>(crc / 256), ByteStatus::Good);
    } else {
      if (witness_.wants_checksum()) {
        const std::uint8_t sum = dcon_sum(request.data, request.size);
        byte(upper_hex(sum / 16U), ByteStatus::Good);
        byte(upper_hex(sum), ByteStatus::Good);
      }
      byte('\r', ByteStatus::Good);
    }
    wait_for_quiet();
    return {reply_.data(), reply_size_};
  }

  // --- ModuleObserver ---

  void reply_begins(Bytes reply) override {
    witness_.follow(values(), module_.now());
    witness_.reply_begins(reply, module_.now());
    std::copy(reply.begin(), reply.end(), reply_.begin());
    reply_size_ = reply.size - (speaks_modbus() ? 2 : witness_.wants_checksum() ? 3 : 1);
  }

  void reply_ends() override { witness_.reply_ends(module_.now()); }

  void outputs_change(std::uint16_t channels) override {
    require(!booting_ || outputs_ == 0, "outputs come up without a glitch");
    outputs_ = channels;
    if (!booting_) {
      witness_.follow(values(), module_.now());
    }
  }

  void turned() override {
    if (!booting_) {
      witness_.follow(values(), module_.now());
      witness_.follow_address(in_force().address);
    }
  }

 private:
  [[nodiscard]] const State& state() const { return module_.module().state(); }

  [[nodiscard]] judges::Values values() const { return judges::values_of(state(), outputs_); }

  void advance_to(Microseconds until) {
    if (held_until_ <= until) {
      module_.advance_to(std::exchange(held_until_, kNever));
      witness_.is_held(false, module_.now());
      module_.hold(false);
    }
    module_.advance_to(until);
  }

  bool strict_gaps_;
  LeanModule module_;
  judges::Witness witness_;
  std::array<std::uint8_t, 256> reply_{};
  std::size_t reply_size_ = 0;
  std::uint16_t outputs_ = 0;
  bool booting_ = false;
  Microseconds held_until_ = kNever;
};

}  // namespace ex9000::fuzz
