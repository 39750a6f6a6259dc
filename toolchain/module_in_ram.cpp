// One module as an image holds it: shows what RAM it takes, and that it is there without code that runs
// before main.
#include "firmware/module.hpp"

namespace ex9000 {

constexpr const Model& kModel = *find_model("EX9042D-M");

extern Module module_in_ram;
Module module_in_ram(kModel);

}  // namespace ex9000
