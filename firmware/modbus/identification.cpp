// Functions 11 and 2B/0E (Modbus Application Protocol V1.1b3, 6.13 and 6.21), and the vendor's function 46
// (manuals, mapping table), which can also store a new address.
#include "firmware/modbus/functions.hpp"

namespace ex9000::modbus {

namespace {

constexpr std::uint8_t kRunning = 0xFF;

constexpr std::string_view kVendor = "OpenEX9000";
constexpr std::uint8_t kReadDeviceIdMei = 0x0E;
constexpr std::uint8_t kConformity = 0x82;  // regular identification, stream access and individual access

enum ReadDeviceIdCode : std::uint8_t { kBasic = 1, kRegular = 2, kExtended = 3, kOneObject = 4 };
enum ObjectId : std::uint8_t {
  kVendorName = 0,
  kProductCode = 1,
  kRevision = 2,
  kVendorUrl = 3,  // optional in the standard; this firmware does not have it
  kProductName = 4,
  kModelName = 5,
  kUserApplicationName = 6,
  kSerialNumber = 0x80,  // ours: private objects begin here
};

constexpr bool exists(std::uint8_t object, std::uint8_t last) {
  return object <= last && object != kVendorUrl &&
         (object <= kUserApplicationName || object == kSerialNumber);
}

void put_object(const State& state, std::uint8_t object, Reply& reply) {
  reply.put(object);
  const std::size_t length_at = reply.size();
  reply.put(std::uint8_t{0});
  switch (object) {
    case kVendorName:
      reply.put(kVendor);
      break;
    case kProductCode:
    case kModelName:
      reply.put(state.model().designation);
      break;
    case kRevision:
      reply.put(state.version.text());
      break;
    case kProductName:
      reply.put(state.model().description);
      break;
    case kSerialNumber:
      for (unsigned bits = 32; bits != 0; bits -= 8) {
        reply.put_hex(static_cast<std::uint8_t>(state.serial_number() >> (bits - 8)));
      }
      break;
    default:
      reply.put(state.settings.name.bytes());
      break;
  }
  reply.patch(length_at, reply.size() - length_at - 1);
}

}  // namespace

Refusal report_server_id(Exchange& exchange) {
  if (exchange.frame.size != 2) {
    return Refusal::WrongLength;
  }
  const Bytes name = exchange.state.settings.name.bytes();
  exchange.reply.put(static_cast<std::uint8_t>(name.size + 3));
  exchange.reply.put_word(exchange.model().modbus_code);
  exchange.reply.put(kRunning);
  exchange.reply.put(name);
  return Refusal::None;
}

Refusal read_device_identification(Exchange& exchange) {
  constexpr std::size_t kMeiAt = 2;
  constexpr std::size_t kCodeAt = 3;
  constexpr std::size_t kObjectAt = 4;
  const Bytes frame = exchange.frame;
  if (frame.size <= kMeiAt) {
    return Refusal::WrongLength;
  }
  if (frame[kMeiAt] != kReadDeviceIdMei) {
    return Refusal::UnknownSubfunction;
  }
  if (frame.size != kObjectAt + 1) {
    return Refusal::WrongLength;
  }
  const std::uint8_t code = frame[kCodeAt];
  std::uint8_t object = frame[kObjectAt];
  if (code < kBasic || code > kOneObject) {
    return Refusal::WrongValue;
  }
  const std::uint8_t last_of_level = code == kBasic       ? kRevision
                                     : code == kOneObject ? kSerialNumber
                                                          : kUserApplicationName;
  if (!exists(object, last_of_level)) {
    if (code == kOneObject) {
      return Refusal::UnknownObject;
    }
    object = kVendorName;  // the standard requires a restart at the first object
  }
  const std::uint8_t last = code == kOneObject ? object : last_of_level;
  exchange.reply.put(kReadDeviceIdMei);
  exchange.reply.put(code);
  exchange.reply.put(kConformity);
  exchange.reply.put(std::uint8_t{0});  // "more follows": no
  exchange.reply.put(std::uint8_t{0});  // next object: none
  const std::size_t count_at = exchange.reply.size();
  exchange.reply.put(std::uint8_t{0});
  std::size_t count = 0;
  for (; object <= last; ++object) {
    if (exists(object, last)) {
      put_object(exchange.state, object, exchange.reply);
      ++count;
    }
  }
  exchange.reply.patch(count_at, count);
  return Refusal::None;
}

Refusal vendor_function(Exchange& exchange) {
  constexpr std::size_t kSubfunctionAt = 2;
  constexpr std::size_t kAddressAt = 3;
  constexpr std::size_t kSetAddressSize = 7;
  constexpr std::uint8_t kReadCode = 0x00;
  constexpr std::uint8_t kSetAddress = 0x04;
  const Bytes frame = exchange.frame;
  if (frame.size <= kSubfunctionAt) {
    return Refusal::WrongLength;
  }
  const std::uint8_t subfunction = frame[kSubfunctionAt];
  if (subfunction == kReadCode) {
    if (frame.size != kSubfunctionAt + 1) {
      return Refusal::WrongLength;
    }
    exchange.reply.put(kReadCode);
    exchange.reply.put(std::uint8_t{0});
    exchange.reply.put_word(exchange.model().modbus_code);
    exchange.reply.put(std::uint8_t{0});
    return Refusal::None;
  }
  if (subfunction != kSetAddress) {
    return Refusal::UnknownSubfunction;
  }
  if (frame.size != kSetAddressSize) {
    return Refusal::WrongLength;
  }
  for (const std::uint8_t reserved : frame.from(kAddressAt + 1)) {
    if (reserved != 0) {
      return Refusal::WrongValue;
    }
  }
  if (!is_modbus_address(frame[kAddressAt])) {
    return Refusal::WrongValue;
  }
  exchange.outcome.change().address = frame[kAddressAt];
  exchange.reply.put(kSetAddress);
  exchange.reply.put_word(0);
  exchange.reply.put_word(0);
  return Refusal::None;
}

}  // namespace ex9000::modbus
