// Which rows, refusals and exceptions random sessions have come to.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace ex9000::reference {

/// Counts what was reached, of a list that is written down: a rule that no session reaches shows.
class Rules {
 public:
  Rules();

  /// Throws std::logic_error where `rule` is not in the list.
  void reached(const std::string& rule);
  /// What was never reached, in the list's order.
  [[nodiscard]] std::vector<std::string> missing() const;
  /// The list, a rule a line, with how often it was reached.
  [[nodiscard]] std::string table() const;
  [[nodiscard]] std::size_t size() const { return counts_.size(); }

 private:
  std::map<std::string, std::uint64_t> counts_;
};

}  // namespace ex9000::reference
