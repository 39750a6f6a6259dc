// Answers DCON (ASCII) requests - wire.md sections 3 and 4.
#pragma once

#include <cstddef>

#include "firmware/bytes.hpp"
#include "firmware/model/model.hpp"
#include "firmware/request/exchange.hpp"

namespace ex9000::dcon {

constexpr std::size_t kNoCommand = static_cast<std::size_t>(-1);

/// Row of kCommands that `frame` calls for on `model`, or kNoCommand. `frame` is as the assembler accepted
/// it: from the delimiter on, without checksum and CR.
std::size_t find_command(const Model& model, Bytes frame);

/// Judges an accepted frame. The reply is what to send, checksum and CR included, once the outcome is done;
/// it stays empty for broadcasts and for another address. Changes nothing by itself.
void answer(Exchange& exchange);

/// The reply of a command that could not be stored.
void refuse_store(Exchange& exchange);

}  // namespace ex9000::dcon
