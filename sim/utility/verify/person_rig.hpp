// A person at the terminal does what the program asks for.
#pragma once

#include <string>
#include <utility>

#include "sim/utility/console/environment.hpp"
#include "sim/utility/verify/rig.hpp"

namespace ex9000::utility {

class PersonRig final : public Rig {
 public:
  explicit PersonRig(AskPerson ask_person) : ask_person_(std::move(ask_person)) {}

  /// Also throws Interrupted if the person enters nothing more.
  std::string ask(const std::string& request) override;
  [[nodiscard]] bool never_does(const std::string& word) const override;

 private:
  AskPerson ask_person_;
};

}  // namespace ex9000::utility
