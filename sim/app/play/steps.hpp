// The steps of transcripts and scenarios.
#pragma once

#include <functional>
#include <string>

#include "firmware/model/model.hpp"
#include "sim/app/play/transcript.hpp"

namespace ex9000::play {

/// Parses the text of a step; variables are replaced. `model`: of a transcript; null: the step is of a
/// scenario, which has more steps. Throws std::invalid_argument with a one-line message.
Step parse_step(unsigned line, const std::string& text, const Model* model);

}  // namespace ex9000::play
