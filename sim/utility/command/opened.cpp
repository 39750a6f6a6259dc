#include "sim/utility/command/opened.hpp"

#include "sim/notation/module_notation.hpp"

namespace ex9000::utility {

namespace {

Identity identified(Device& device, const Options& options) {
  if (options.is_given("timeout")) {
    device.set_patience(options.timeout);
  }
  return identify(device);
}

}  // namespace

Opened::Opened(Environment& environment, MasterLine& line, const std::string& module, const Options& options)
    : device(options.is_given("timeout")
                 ? find_device(environment, line, module, options.speaks, options.timeout)
                 : find_device(environment, line, module, options.speaks)),
      identity(identified(device, options)),
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
