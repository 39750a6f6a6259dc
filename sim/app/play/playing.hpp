// Carries out the steps of one run.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "sim/app/play/target.hpp"

namespace ex9000::play {

/// Throws std::runtime_error if what arrives is not what is expected.
class Playing {
 public:
  /// `rehearses`: steps take no time and expect nothing.
  Playing(Target& target, bool checksum, bool rehearses = false)
      : target_(target), checksum_(checksum), rehearses_(rehearses) {}

  Target& target() { return target_; }
  void set_checksum(bool on) { checksum_ = on; }

  /// Before it, no byte may arrive that no step expects.
  void send(const Bytes& request);
  void send_dcon(const std::string& text) { send(dcon_frame(text)); }
  /// Does not check this: the bytes may be the rest of a frame.
  void send_more(const Bytes& bytes);
  /// At least one reply; all have the same length.
  void expect_one_of(const std::vector<Bytes>& permitted);
  void expect_dcon(const std::string& text) { expect_one_of({dcon_frame(text)}); }
  void expect_outputs(std::uint16_t channels);
  void expect_led(Led shows);
  void nothing_for(std::chrono::nanoseconds time);
  void nothing_more();

 private:
  [[nodiscard]] Bytes dcon_frame(const std::string& text) const;

  Target& target_;
  bool checksum_;
  bool rehearses_;
  bool reply_pending_ = false;  ///< bytes were sent, and a reply may still arrive
};

}  // namespace ex9000::play
