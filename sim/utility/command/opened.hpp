// The module of a command line, found and identified.
#pragma once

#include <string>

#include "sim/utility/command/verb.hpp"
#include "sim/utility/device/find.hpp"

namespace ex9000::utility {

class Opened {
 public:
  /// Throws like find_device; std::invalid_argument if `--model` is wrong or must be given.
  Opened(Environment& environment, MasterLine& line, const std::string& module, const Options& options);

  [[nodiscard]] MasterLine& line() { return device.line(); }

  Device device;
  Identity identity;
  /// The functions of the tables need one.
  const Model* model;
};

}  // namespace ex9000::utility
