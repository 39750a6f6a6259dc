// Replies to DCON (ASCII) requests - wire.md sections 3 and 4.
#pragma once

#include <cstddef>

#include "firmware/bytes.hpp"
#include "firmware/model/model.hpp"
#include "firmware/request/exchange.hpp"

namespace ex9000::dcon {

constexpr std::size_t kNoCommand = static_cast<std::size_t>(-1);

/// The index of the command among the rows of kCommands that a built model has (model/built.hpp), or
/// kNoCommand. `frame`: from the delimiter on, without checksum and CR.
std::size_t find_command(const Model& model, Bytes frame);

/// Judges the frame and writes the outcome and the whole reply, with checksum (if in force) and CR; changes
/// nothing else. The module must carry out the outcome before it sends the reply, which is empty for `#**`,
/// `~**` and frames for another address.
void answer(Exchange& exchange);

/// If the settings could not be stored: the reply becomes `?AA`, with checksum (if in force) and CR.
void refuse_store(Exchange& exchange);

}  // namespace ex9000::dcon
