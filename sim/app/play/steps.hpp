// The steps of transcripts and scenarios.
#pragma once

#include <functional>
#include <string>

#include "firmware/model/model.hpp"
#include "sim/app/play/transcript.hpp"

namespace ex9000::play {

/// `text`: variables are replaced. `model`: null for a step of a scenario, which has more steps.
Step parse_step(unsigned line, const std::string& text, const Model* model);

}  // namespace ex9000::play
