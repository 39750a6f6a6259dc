// The update of several modules: first all receive the image, one after the other, then all start it.
#pragma once

#include <vector>

#include "sim/utility/console/environment.hpp"
#include "sim/utility/modbus/master.hpp"
#include "sim/utility/update/update_file.hpp"

namespace ex9000::utility {

/// Reports the result of each module. `wait`: until they have confirmed the image. Returns whether all have
/// been updated. Throws what Connection throws; the text then says what has become of the modules.
bool update_modules(Environment& environment, Master& master, const std::vector<Addressee>& modules,
                    const UpdateFile& file, bool wait);

}  // namespace ex9000::utility
