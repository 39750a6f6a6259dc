// Replies to DCON (ASCII) requests - wire.md sections 3 and 4.
#pragma once

#include <cstddef>

#include "firmware/bytes.hpp"
#include "firmware/model/model.hpp"
#include "firmware/request/exchange.hpp"

namespace ex9000::dcon {

constexpr std::size_t kNoCommand = static_cast<std::size_t>(-1);

/// Returns the index of the command in `frame` among the rows of kCommands that the built models have, or
/// kNoCommand if `model` has no such command. `frame` begins with the delimiter and has no checksum and no
/// CR.
std::size_t find_command(const Model& model, Bytes frame);

/// Judges the frame of `exchange` and writes its reply, including checksum and CR. The reply must be sent
/// after the outcome has been carried out; it is empty for broadcasts and for other addresses. Changes
/// nothing but `exchange`.
void answer(Exchange& exchange);

/// Replaces the reply with `?AA`, because the settings could not be stored.
void refuse_store(Exchange& exchange);

}  // namespace ex9000::dcon
