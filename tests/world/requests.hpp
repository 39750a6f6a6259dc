// Random requests, made from those of the transcripts.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/oracles/reference/module.hpp"
#include "tests/oracles/reference/random.hpp"

namespace ex9000::world {

using reference::Bytes;

class Requests {
 public:
  /// Loads all transcripts.
  Requests();

  /// A request for the module, or a similar one, with its check. Some are for other modules, wrong or
  /// damaged.
  Bytes next(const reference::Module& module, reference::Random& random) const;
  /// A request that sets the filter time of an input.
  Bytes set_filter(const reference::Module& module, unsigned channel, reference::Random& random) const;

 private:
  /// The requests that a transcript sends to a model, without their checks.
  struct Pool {
    std::vector<Bytes> ascii;
    std::vector<Bytes> modbus;
  };

  std::map<std::string, Pool> pools_;  ///< by designation
};

}  // namespace ex9000::world
