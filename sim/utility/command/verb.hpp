// The commands of the program.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/model.hpp"
#include "sim/notation/setting.hpp"
#include "sim/text/words.hpp"
#include "sim/utility/device/find.hpp"

namespace ex9000::utility {

struct Options {
  hal::SerialMode line{9600, LineFormat::k8N1};
  bool checksum = false;  ///< of DCON frames
  Speaks speaks = Speaks::Unknown;
  std::string model;  ///< empty: as the module says
  std::string entry;  ///< of a file with several modules; empty: that of the module
  bool dry_run = false;
  Time every = std::chrono::seconds(1);
  std::uint32_t rounds = 0;  ///< 0: without end
  bool fast = false;
  std::string addresses;  ///< empty: all
  Time timeout = std::chrono::milliseconds(80);
  bool json = false;
  bool wait = false;
  std::optional<std::string> rig;     ///< a command
  std::optional<std::string> report;  ///< a path
  sim::Places places;

  [[nodiscard]] bool is_given(std::string_view option) const { return places.count(option) != 0; }
};

extern const std::vector<sim::Setting<Options>> known_options;

struct Verb {
  std::string_view shape;  ///< the command and its arguments, see sim/notation/shape.hpp
  std::string_view does;   ///< for help: a verb phrase
  std::string_view more;   ///< lines for its own help
  std::vector<std::string_view> options;
  /// Gets the arguments, which have the form of `shape`. Returns whether all is well; what is not has been
  /// reported. Throws std::invalid_argument for wrong input, std::runtime_error for what breaks.
  bool (*run)(Environment& environment, const sim::Words& args, const Options& options);

  [[nodiscard]] std::string_view name() const { return shape.substr(0, shape.find(' ')); }
  [[nodiscard]] bool takes(std::string_view option) const {
    return std::find(options.begin(), options.end(), option) != options.end();
  }
};

extern const std::vector<Verb> verbs;

}  // namespace ex9000::utility
