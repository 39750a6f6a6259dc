// A module on the line, as a Modbus master sees it.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "sim/utility/modbus/master.hpp"

namespace ex9000::utility {

/// A module gives no reply or a wrong one, or refuses a request. The text says what to do.
struct Failed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The data of a reply, after its known beginning, or an exception.
struct Answer {
  Data data;
  std::uint8_t exception = 0;

  [[nodiscard]] bool refused() const { return exception != 0; }
  [[nodiscard]] unsigned word(std::size_t index) const {
    return Bytes{data.data(), data.size()}.word(2 * index);
  }
  /// One character in each word, up to the first that is 0.
  [[nodiscard]] std::string text() const;
};

/// For people, for example `exception 02 (illegal data address)`.
std::string exception_text(std::uint8_t exception);

class Module {
 public:
  /// The reply to most requests begins within this time (wire.md section 3).
  static constexpr std::chrono::milliseconds kPatience{1000};

  Module(Master& master, Addressee to) : master_(&master), to_(std::move(to)) {}

  [[nodiscard]] const std::string& name() const { return to_.name; }
  [[nodiscard]] const Addressee& addressee() const { return to_; }
  /// Once. nullopt: no reply, also if a gateway reports this.
  std::optional<Answer> try_once(const Request& request, Time patience = kPatience);
  /// Repeated if there is no reply. Throws Failed if there is still none.
  Answer ask(const Request& request, Time patience = kPatience);
  void pause(Time time) { master_->connection().pause(time); }

 private:
  Master* master_;
  Addressee to_;
};

}  // namespace ex9000::utility
