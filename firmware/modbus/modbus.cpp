#include "firmware/modbus/modbus.hpp"

#include <array>

#include "firmware/line/crc16.hpp"
#include "firmware/line/rtu_frames.hpp"
#include "firmware/modbus/functions.hpp"
#include "firmware/model/built.hpp"

namespace ex9000::modbus {

namespace {

/// Exception codes: Modbus Application Protocol V1.1b3, 7.
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
      return has(model, row.needs) ? &row : nullptr;
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
}

/// To which the request is addressed, high byte first.
Bytes serial_number_of(const Exchange& exchange) {
  constexpr std::size_t kBefore = 3;
  return {exchange.frame.data - kBefore, kBefore + 1};
}

bool is_own_number(const Exchange& exchange) {
  constexpr unsigned kBitsOfAWord = 16;
  const Bytes number = serial_number_of(exchange);
  return (std::uint32_t{number.word(0)} << kBitsOfAWord | number.word(2)) == exchange.state.serial_number();
}

/// The last byte of the number follows as the address of the reply.
[[gnu::noinline]] void put_prefix(Bytes serial_number, Reply& reply) {
  const std::array<std::uint8_t, kNumberPrefix> prefix{kScanAddress,     kScanFunction,    kReplyByNumber,
                                                       serial_number[0], serial_number[1], serial_number[2]};
  reply.put(Bytes{prefix.data(), prefix.size()});
  reply.end_prefix();
}

}  // namespace

void answer(Exchange& exchange) {
  const Bytes frame = exchange.frame;
  Reply& reply = exchange.reply;
  const std::uint8_t function = frame[1];
  exchange.broadcast = !exchange.by_serial_number && frame[0] == kBroadcast;
  // A write may have changed address or number since the frame was received (wire.md D16).
  if (exchange.by_serial_number) {
    if (!is_own_number(exchange)) {
      return;
    }
    put_prefix(serial_number_of(exchange), reply);
  } else if (!exchange.broadcast && frame[0] != exchange.state.in_force.address) {
    return;
  }
  const FunctionRow* row = find(exchange.model(), function);
  if (exchange.broadcast && (row == nullptr || row->at_broadcast == AtBroadcast::Ignored)) {
    return;
  }
  reply.put(frame[0]);
  reply.put(function);
  Refusal refusal = row == nullptr ? Refusal::UnknownFunction : row->handler(exchange);
  if (refusal == Refusal::None) {
    refusal = exchange.judge_outcome();
  }
  exchange.outcome.refusal = refusal;
  if (exchange.broadcast) {
    reply.clear();
    return;
  }
  if (refusal != Refusal::None) {
    write_exception(frame[0], function, refusal, reply);
  }
  append_crc(reply);
}

void refuse_store(Exchange& exchange) {
  Reply& reply = exchange.reply;
  if (!reply.empty()) {
    const Bytes written = reply.after_prefix();
    write_exception(written[0], written[1], Refusal::StoreFailed, reply);
    append_crc(reply);
  }
}

}  // namespace ex9000::modbus
