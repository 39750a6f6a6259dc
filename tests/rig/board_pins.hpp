// Where the emulated board has the module's signals.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace ex9000::rig {

struct Pin {
  char port;
  unsigned number;
};

constexpr Pin kDriverEnable{'A', 6};
constexpr Pin kInitSwitch{'A', 7};  ///< 0 = tied to GND
constexpr Pin kLed{'F', 0};
constexpr std::array<Pin, 16> kOutputs{{{'D', 1},
                                        {'D', 2},
                                        {'D', 3},
                                        {'D', 4},
                                        {'D', 5},
                                        {'D', 6},
                                        {'D', 7},
                                        {'G', 0},
                                        {'B', 0},
                                        {'B', 1},
                                        {'B', 4},
                                        {'B', 5},
                                        {'B', 6},
                                        {'C', 4},
                                        {'C', 5},
                                        {'C', 6}}};
constexpr std::array<Pin, 8> kInputs{
    {{'B', 0}, {'B', 1}, {'B', 4}, {'B', 5}, {'B', 6}, {'C', 4}, {'C', 5}, {'C', 6}}};

}  // namespace ex9000::rig
