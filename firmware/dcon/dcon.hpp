// Replies to DCON (ASCII) requests - wire.md sections 3 and 4.
#pragma once

#include <cstddef>

#include "firmware/bytes.hpp"
#include "firmware/model/model.hpp"
#include "firmware/request/exchange.hpp"

namespace ex9000::dcon {

constexpr std::size_t kNoCommand = static_cast<std::size_t>(-1);

/// Finds the row of the command that `frame` contains. Returns the index of the row, or kNoCommand if `model`
/// has no such command. The index counts only the rows of kCommands that at least one built model has
/// (model/built.hpp). `frame` begins with delimiter and address, and has no checksum and no CR.
std::size_t find_command(const Model& model, Bytes frame);

/// Judges the frame of `exchange` and writes the outcome and the reply, including the checksum, if it is in
/// force, and CR. The module must carry out the outcome before it sends the reply. The reply is empty if the
/// frame is `#**` or `~**`, or is for another address. Changes nothing but `exchange`.
void answer(Exchange& exchange);

/// Replaces the reply with `?AA`, the checksum if it is in force, and CR. Call this if the settings could not
/// be stored.
void refuse_store(Exchange& exchange);

}  // namespace ex9000::dcon
