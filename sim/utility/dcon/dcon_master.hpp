// A DCON master.
#pragma once

#include <optional>
#include <string>

#include "sim/utility/connection/connection.hpp"

namespace ex9000::utility {

/// The command with its checksum, if it gets one, and CR.
Data dcon_frame(const std::string& command, bool checksum);

class DconMaster {
 public:
  /// A reply begins within 20 ms, 200 ms after a store, plus a response delay (wire.md section 3); an adapter
  /// may hold its bytes back for 16 ms.
  static constexpr std::chrono::milliseconds kPatience{300};

  DconMaster(Connection& connection, hal::SerialMode mode)
      : connection_(connection), character_(longest_character(mode)) {}

  /// Of the line, from now on.
  void set_mode(hal::SerialMode mode) { character_ = longest_character(mode); }
  /// Of requests and replies.
  void set_checksum(bool on) { checksum_ = on; }
  [[nodiscard]] bool checksum() const { return checksum_; }

  /// The reply without checksum and CR, from its lead `!`, `>` or `?` on; bytes before it, as those of an
  /// echo, are skipped. nullopt: none, or one with a wrong checksum or characters that are not printable.
  /// Throws what Connection throws.
  std::optional<std::string> ask(const std::string& command, Time patience = kPatience);
  /// After the last command, if it had no reply.
  [[nodiscard]] Heard heard() const { return heard_; }

 private:
  Connection& connection_;
  Time character_;
  bool checksum_ = false;
  Heard heard_ = Heard::Nothing;
};

}  // namespace ex9000::utility
