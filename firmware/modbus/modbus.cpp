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
    case Refusal::UpdateRefused:
    case Refusal::NotPermitted:
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

/// Of a serial number, before the byte that stands for the address.
constexpr std::size_t kNumberBytesBefore = kNumberPrefix - kNumberAt;

bool is_own_number(const Exchange& exchange) {
  constexpr unsigned kBitsOfAWord = 16;
  const Bytes number{exchange.frame.data - kNumberBytesBefore, kNumberBytesBefore + 1};
  return (std::uint32_t{number.word(0)} << kBitsOfAWord | number.word(2)) == exchange.state.serial_number();
}

void put_prefix(const std::uint8_t* begin_of_number, Reply& reply) {
  const std::array<std::uint8_t, kNumberPrefix> prefix{kScanAddress,       kScanFunction,
                                                       kReplyByNumber,     begin_of_number[0],
                                                       begin_of_number[1], begin_of_number[2]};
  reply.put_first({prefix.data(), prefix.size()});
}

}  // namespace

void answer(Exchange& exchange) {
  const Bytes frame = exchange.frame;
  Reply& reply = exchange.reply;
  const std::uint8_t function = frame[1];
  exchange.broadcast = !exchange.by_serial_number && frame[0] == kBroadcast;
  // A write may have changed address or number since the frame was received (wire.md D16).
  if (exchange.by_serial_number ? !is_own_number(exchange)
                                : !exchange.broadcast && frame[0] != exchange.state.in_force.address) {
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
  if (exchange.by_serial_number) {
    put_prefix(frame.data - kNumberBytesBefore, reply);
  }
  append_crc(reply);
}

void refuse(Exchange& exchange) {
  Reply& reply = exchange.reply;
  if (reply.empty()) {
    return;
  }
  const std::size_t address_at = exchange.by_serial_number ? kNumberPrefix : 0;
  const Bytes written = reply.bytes();
  const std::array<std::uint8_t, kNumberBytesBefore> number{written[kNumberAt], written[kNumberAt + 1],
                                                            written[kNumberAt + 2]};
  write_exception(written[address_at], written[address_at + 1], exchange.outcome.refusal, reply);
  if (exchange.by_serial_number) {
    put_prefix(number.data(), reply);
  }
  append_crc(reply);
}

}  // namespace ex9000::modbus
