// `ex9000 verify`: plays transcripts against a module, and restores its settings.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/app/play/transcript.hpp"
#include "sim/utility/console/environment.hpp"
#include "sim/utility/modbus/addressee.hpp"
#include "sim/utility/verify/rig.hpp"

namespace ex9000::utility {

struct VerifyTask {
  Port port;
  Addressee module;
  std::vector<play::Transcript> transcripts;
  const Model* model = nullptr;       ///< null: as the module says
  std::optional<std::string> report;  ///< path; nullopt: standard output
};

/// Whether runs have passed, none has failed, and the module has its settings again.
bool verify(Environment& environment, const VerifyTask& task, Rig& rig);

}  // namespace ex9000::utility
