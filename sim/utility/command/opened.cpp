#include "sim/utility/command/opened.hpp"

#include "sim/notation/module_notation.hpp"

namespace ex9000::utility {

Opened::Opened(Environment& environment, MasterLine& line, const std::string& module, const Options& options)
    : device(find_device(environment, line, module, options.speaks)),
      identity(identify(device)),
      model(options.model.empty() ? identity.model : &sim::model_called(options.model)) {
  if (device.speaks_modbus() && identity.model != nullptr && model != identity.model) {
    sim::fail("--model: " + module + " is an " + identity.model_text + "; leave out the option");
  }
  if (model == nullptr) {
    sim::fail(module + ": the model of '" + identity.model_text + identity.name +
              "' is unknown; name it with --model");
  }
}

}  // namespace ex9000::utility
