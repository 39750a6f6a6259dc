#include "firmware/modbus/modbus.hpp"

#include <array>

#include "firmware/line/crc16.hpp"
#include "firmware/modbus/functions.hpp"
#include "firmware/model/built.hpp"

namespace ex9000::modbus {

namespace {

constexpr std::uint8_t kBroadcast = 0;
constexpr std::uint8_t kExceptionFlag = 0x80;

/// Modbus Application Protocol V1.1b3, 7.
enum Exception : std::uint8_t {
  kIllegalFunction = 1,
  kIllegalDataAddress = 2,
  kIllegalDataValue = 3,
  kServerDeviceFailure = 4,
};

constexpr auto kRows = rows_of_built_models<kFunctions, &Function::row>();

const FunctionRow* find(const Model& model, std::uint8_t code) {
  for (const FunctionRow& row : kRows) {
    if (row.code == code) {
      return meets(model, row.needs) ? &row : nullptr;
    }
  }
  return nullptr;
}

std::uint8_t exception_of(Refusal refusal, std::uint8_t function) {
  constexpr std::uint8_t kVendorFunction = 0x46;
  switch (refusal) {
    case Refusal::UnknownSubfunction:
      return function == kVendorFunction ? kIllegalDataAddress : kIllegalFunction;
    case Refusal::WrongAddress:
    case Refusal::UnknownObject:
      return kIllegalDataAddress;
    case Refusal::WrongLength:
    case Refusal::WrongQuantity:
    case Refusal::WrongCoilValue:
    case Refusal::WrongValue:
      return kIllegalDataValue;
    case Refusal::OutputsBlocked:
    case Refusal::StoreFailed:
      return kServerDeviceFailure;
    default:
      return kIllegalFunction;
  }
}

void append_crc(Reply& reply) {
  const Crc16 crc = crc16(reply.bytes());
  reply.put(crc.low_byte());
  reply.put(crc.high_byte());
}

void write_exception(std::uint8_t address, std::uint8_t function, Refusal refusal, Reply& reply) {
  reply.clear();
  reply.put(address);
  reply.put(static_cast<std::uint8_t>(function | kExceptionFlag));
  reply.put(exception_of(refusal, function));
  append_crc(reply);
}

}  // namespace

void answer(const State& state, Bytes frame, Outcome& outcome, Reply& reply) {
  const Request request{frame, frame[0] == kBroadcast};
  const std::uint8_t function = frame[1];
  const FunctionRow* row = find(state.model(), function);
  if (request.broadcast && (row == nullptr || !row->by_broadcast)) {
    return;
  }
  reply.put(frame[0]);
  reply.put(function);
  outcome.refusal = row == nullptr ? Refusal::UnknownFunction : row->handler(state, request, outcome, reply);
  if (request.broadcast) {
    reply.clear();
  } else if (outcome.refusal != Refusal::None) {
    write_exception(frame[0], function, outcome.refusal, reply);
  } else {
    append_crc(reply);
  }
}

void refuse_store(Reply& reply) {
  if (!reply.empty()) {
    const Bytes written = reply.bytes();
    write_exception(written[0], written[1], Refusal::StoreFailed, reply);
  }
}

}  // namespace ex9000::modbus
