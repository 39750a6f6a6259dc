// Function 08: Modbus Application Protocol V1.1b3, 6.8; what the counters count: Modbus over Serial Line
// V1.02, appendix A, and D1.
#include "firmware/modbus/functions.hpp"

namespace ex9000::modbus {

namespace {

constexpr std::size_t kDataAt = 4;
constexpr std::size_t kOneWord = kDataAt + 2;

enum Subfunction : std::uint16_t {
  kReturnQueryData = 0x00,
  kClearCounters = 0x0A,
  kBusMessages = 0x0B,
  kBusErrors = 0x0C,
  kExceptions = 0x0D,
  kServerMessages = 0x0E,
  kNoResponses = 0x0F,
  kOverruns = 0x12,
};

const std::uint16_t* counter_of(const Diagnostics& diagnostics, std::uint16_t subfunction) {
  switch (subfunction) {
    case kBusMessages:
      return &diagnostics.bus_messages;
    case kBusErrors:
      return &diagnostics.bus_errors;
    case kExceptions:
      return &diagnostics.exceptions;
    case kServerMessages:
      return &diagnostics.server_messages;
    case kNoResponses:
      return &diagnostics.no_responses;
    case kOverruns:
      return &diagnostics.overruns;
    default:
      return nullptr;
  }
}

}  // namespace

Refusal diagnose(const State& state, const Request& request, Outcome& outcome, Reply& reply) {
  const Bytes frame = request.frame;
  if (frame.size < kDataAt) {
    return Refusal::WrongLength;
  }
  const std::uint16_t subfunction = frame.word(2);
  if (subfunction == kReturnQueryData) {
    if (frame.size < kOneWord || frame.size % 2 != 0) {
      return Refusal::WrongLength;
    }
    reply.put(frame.from(2));
    return Refusal::None;
  }
  const std::uint16_t* counter = counter_of(state.diagnostics, subfunction);
  if (counter == nullptr && subfunction != kClearCounters) {
    return Refusal::UnknownSubfunction;
  }
  if (frame.size != kOneWord) {
    return Refusal::WrongLength;
  }
  if (frame.word(kDataAt) != 0) {
    return Refusal::WrongValue;
  }
  outcome.clear_diagnostics = subfunction == kClearCounters;
  reply.put_word(subfunction);
  reply.put_word(counter == nullptr ? 0U : *counter);
  return Refusal::None;
}

}  // namespace ex9000::modbus
