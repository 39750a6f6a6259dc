#include "sim/utility/command/verify_module.hpp"

#include <iterator>
#include <memory>

#include "sim/notation/module_notation.hpp"
#include "sim/utility/verify/command_rig.hpp"
#include "sim/utility/verify/person_rig.hpp"
#include "sim/utility/verify/verify.hpp"

namespace ex9000::utility {

namespace {

std::unique_ptr<Rig> rig_for(const Environment& environment, const Options& options) {
  if (options.rig) {
    return std::make_unique<CommandRig>(*options.rig);
  }
  if (environment.ask_person) {
    return std::make_unique<PersonRig>(environment.ask_person);
  }
  return std::make_unique<NoRig>();
}

Addressee module_of(const std::string& text) {
  constexpr std::size_t kDigitsOfSerialNumber = 8;
  return text.size() == kDigitsOfSerialNumber ? parse_addressee(text) : at_address(parse_address(text));
}

}  // namespace

bool verify_module(Environment& environment, const sim::Words& args, const Options& options) {
  VerifyTask task{parse_port(args[0]), module_of(args[1]), {}, nullptr, options.report};
  if (!options.model.empty()) {
    task.model = &sim::model_called(options.model);
  }
  for (auto path = args.begin() + 2; path != args.end(); ++path) {
    std::vector<play::Transcript> loaded = play::load_all(*path);
    std::move(loaded.begin(), loaded.end(), std::back_inserter(task.transcripts));
  }
  const std::unique_ptr<Rig> rig = rig_for(environment, options);
  return verify(environment, task, *rig);
}

}  // namespace ex9000::utility
