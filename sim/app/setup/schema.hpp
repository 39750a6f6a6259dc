// The JSON Schema of bus files, for editors.
#pragma once

#include <string>

namespace ex9000::sim {

std::string bus_file_schema();

}  // namespace ex9000::sim
