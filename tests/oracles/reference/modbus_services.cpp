// Functions 08, 11, 2B and 46 of the reference: wire.md 7.
#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/oracles/reference/modbus_refusal.hpp"
#include "tests/oracles/reference/module.hpp"

namespace ex9000::reference {

/// Executes function 08: Modbus Application Protocol V1.1b3, 6.8.
Bytes Module::diagnostics(const Bytes& frame) {
  if (frame.size() < 4) {
    throw Exception{0x03, "FC08 03 length"};
  }
  const unsigned sub_function = word(frame, 2);
  const std::string name = "FC08 " + hex(sub_function, 2);
  if (sub_function == 0x00) {
    // The data is one word or more, and the reply returns it unchanged.
    if (frame.size() < 6 || frame.size() % 2 != 0) {
      throw Exception{0x03, "FC08 03 length"};
    }
    return frame;
  }
  unsigned count = 0;
  switch (sub_function) {
    case 0x0A:
      break;
    case 0x0B:
      count = counts_.bus_messages;
      break;
    case 0x0C:
      count = counts_.crc_errors;
      break;
    case 0x0D:
      count = counts_.exceptions;
      break;
    case 0x0E:
      count = counts_.server_messages;
      break;
    case 0x0F:
      count = counts_.no_response;
      break;
    case 0x12:
      count = counts_.lost;
      break;
    default:
      throw Exception{0x01, "FC08 01"};
  }
  length_must_be(frame, 6);
  if (word(frame, 4) != 0x0000) {
    throw Exception{0x03, "FC08 03 data"};
  }
  if (sub_function == 0x0A) {
    counts_ = {};
    return frame;
  }
  Bytes reply(frame.begin(), frame.begin() + 4);
  append_word(reply, count);
  return reply;
}

Bytes Module::server_id(const Bytes& frame) {
  length_must_be(frame, 2);
  Bytes reply = {frame[0], 0x11, static_cast<std::uint8_t>(3 + stored_.name.size())};
  append_word(reply, row_->code);
  reply.push_back(0xFF);
  append_text(reply, stored_.name);
  return reply;
}

/// Executes function 2B: Modbus Application Protocol V1.1b3, 6.21.
Bytes Module::device_identification(const Bytes& frame) {
  if (frame.size() < 3) {
    throw Exception{0x03, "FC2B 03 length"};
  }
  if (frame[2] != 0x0E) {
    throw Exception{0x01, "FC2B 01"};
  }
  length_must_be(frame, 5);
  const unsigned asked = frame[3];
  unsigned object = frame[4];
  if (asked < 0x01 || asked > 0x04) {
    throw Exception{0x03, "FC2B 03 code"};
  }
  const std::string texts[] = {"OpenEX9000",   row_->designation, version_text(), "",
                               row_->in_words, row_->designation, stored_.name};
  if (asked == 0x04 && object == 0x80) {  // extensions.md: the serial number
    Bytes reply = {frame[0], 0x2B, 0x0E, 0x04, 0x82, 0x00, 0x00, 0x01, 0x80, 0x08};
    append_text(reply, hex(serial_number(), 8));
    return reply;
  }
  const auto present = [](unsigned id) { return id <= 0x06 && id != 0x03; };
  unsigned last = asked == 0x01 ? 0x02 : 0x06;
  if (asked == 0x04) {
    if (!present(object)) {
      throw Exception{0x02, "FC2B 02"};
    }
    last = object;
  } else if (!present(object) || object > last) {
    // 6.21: "If the Object Id does not match any known object, the server responds as if object 0 were
    // pointed out".
    object = 0x00;
  }
  Bytes reply = {frame[0], 0x2B, 0x0E, static_cast<std::uint8_t>(asked), 0x82, 0x00, 0x00, 0x00};
  for (; object <= last; ++object) {
    if (present(object)) {
      reply[7] += 1;
      reply.push_back(static_cast<std::uint8_t>(object));
      reply.push_back(static_cast<std::uint8_t>(texts[object].size()));
      append_text(reply, texts[object]);
    }
  }
  return reply;
}

Bytes Module::function_46(const Bytes& frame) {
  if (frame.size() < 3) {
    throw Exception{0x03, "FC46 03 length"};
  }
  if (frame[2] == 0x00) {
    length_must_be(frame, 3);
    Bytes reply = {frame[0], 0x46, 0x00, 0x00};
    append_word(reply, row_->code);
    reply.push_back(0x00);
    return reply;
  }
  if (frame[2] != 0x04) {
    throw Exception{0x02, "FC46 02"};
  }
  length_must_be(frame, 7);
  if (frame[3] < 1 || frame[3] > 247) {
    throw Exception{0x03, "FC46 03 range"};
  }
  if (frame[4] != 0 || frame[5] != 0 || frame[6] != 0) {
    throw Exception{0x03, "FC46 03 reserved"};
  }
  set().address = frame[3];
  return {frame[0], 0x46, 0x04, 0x00, 0x00, 0x00, 0x00};
}

}  // namespace ex9000::reference
