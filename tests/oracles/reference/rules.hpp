// Counts how often random sessions reach each rule that the reference names, for example a command, a refusal
// or an exception.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tests/oracles/reference/extension_registers.hpp"
#include "tests/oracles/reference/models.hpp"

namespace ex9000::reference {

/// Counts how often each rule of a fixed list was reached, so that a rule that no session reaches is found.
class Rules {
 public:
  /// Without extensions, the list does not contain the rules that only a module with extensions applies.
  explicit Rules(Extensions extensions = Extensions::Present);

  /// Counts `rule`. Throws std::logic_error if `rule` is not in the list.
  void reached(const std::string& rule);
  /// Returns the rules that were never reached, in the order of the list.
  [[nodiscard]] std::vector<std::string> missing() const;
  /// Returns the list as text. Each line has the count of one rule, and then the rule.
  [[nodiscard]] std::string table() const;
  [[nodiscard]] std::size_t size() const { return list_.size(); }

 private:
  /// Adds the rules of reading and writing a row of extension registers.
  void add_rules_of(const ExtensionRow& row);

  std::vector<std::string> list_;
  std::map<std::string, std::uint64_t> counts_;
};

}  // namespace ex9000::reference
