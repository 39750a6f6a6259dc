// The word of hal/kept_word.hpp: RAM keeps its content through every reset but the loss of the supply.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"

namespace ex9000::hal::stellaris {

/// `word`: a variable that the start of an image does not initialise.
template <WrittenByMainLoop<std::uint32_t>& word>
class KeptWord {
 public:
  [[nodiscard]] static std::uint32_t load() { return word.load(); }
  static void store(std::uint32_t value) { word.store_in_main_loop(value); }
};

}  // namespace ex9000::hal::stellaris
