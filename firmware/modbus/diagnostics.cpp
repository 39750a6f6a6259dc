// Function 08: Modbus Application Protocol V1.1b3, 6.8; counters: Serial Line V1.02, appendix A, wire.md D1.
#include "firmware/modbus/functions.hpp"
#include "firmware/registers/tallies.hpp"

namespace ex9000::modbus {

namespace {

using namespace registers;

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

constexpr int kNoCounter = -1;

int counter_of(const Exchange& exchange, std::uint16_t subfunction) {
  switch (subfunction) {
    case kClearCounters:
      return 0;  // the reply echoes the request, whose data is 0
    case kBusMessages:
      return count_of(exchange, Tally::BusMessages);
    case kBusErrors:
      return count_of(exchange, Tally::BusErrors);
    case kExceptions:
      return count_of(exchange, Tally::Exceptions);
    case kServerMessages:
      return count_of(exchange, Tally::ServerMessages);
    case kNoResponses:
      return count_of(exchange, Tally::NoResponses);
    case kOverruns:
      return count_of(exchange, Tally::Overruns);
    default:
      return kNoCounter;
  }
}

}  // namespace

Refusal diagnose(Exchange& exchange) {
  const Bytes frame = exchange.frame;
  if (frame.size < kDataAt) {
    return Refusal::WrongLength;
  }
  const std::uint16_t subfunction = frame.word(2);
  if (subfunction == kReturnQueryData) {
    if (frame.size < kOneWord || frame.size % 2 != 0) {
      return Refusal::WrongLength;
    }
    exchange.reply.put(frame.from(2));
    return Refusal::None;
  }
  const int counter = counter_of(exchange, subfunction);
  if (counter == kNoCounter) {
    return Refusal::UnknownSubfunction;
  }
  if (frame.size != kOneWord) {
    return Refusal::WrongLength;
  }
  if (frame.word(kDataAt) != 0) {
    return Refusal::WrongValue;
  }
  if (subfunction == kClearCounters) {
    exchange.outcome.request(Effect::ClearDiagnostics);
  }
  exchange.reply.put_word(subfunction);
  exchange.reply.put_word(static_cast<unsigned>(counter));
  return Refusal::None;
}

}  // namespace ex9000::modbus
