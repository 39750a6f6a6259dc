// Modbus requests with arguments in and out of range, and invalid frames: wire.md 7.
#include <algorithm>

#include "sim/app/play/modbus_frame.hpp"
#include "tests/oracles/reference/generator.hpp"
#include "tests/oracles/reference/modbus_refusal.hpp"

namespace ex9000::reference {

namespace {

std::uint8_t any_byte(Random& random) { return static_cast<std::uint8_t>(random.below(256)); }

unsigned coil_address(const Module& module, Random& random) {
  const unsigned channel = random.once_in(4) ? random.below(18) : random.below(8);
  const unsigned rows[] = {0x0000, 0x0080, 0x00A0, 0x0020, 0x0040, 0x0060, 0x0200};
  switch (random.below(12)) {
    case 0:
      return random.one_of({0x0100U, 0x0104U, 0x0104U, 0x0107U, 0x010DU});
    case 1:
      if (module.row().inputs == 0) {
        return random.one_of({0x0104U, 0x010DU});
      }
      return module.has_extensions() ? random.one_of({0x0107U, 0x08CAU}) : 0x0107U;
    case 2:
      return random.one_of({0x00FFU, 0x0101U, 0x0103U, 0x0105U, 0x0106U, 0x0108U, 0x010CU, 0x010EU, 0x08C9U,
                            0x08CBU, 0xFFFFU});
    case 3:
      return random.below(0x10000);
    default:
      return module.row().inputs == 0 && !random.once_in(8) ? rows[random.below(3)] + channel
                                                            : rows[random.below(7)] + channel;
  }
}

unsigned coil_quantity(const Module& module, unsigned address, Random& random) {
  const bool single = (address >= 0x0100 && address < 0x0110) || address == 0x08CA;
  if (single && !random.once_in(4)) {
    return 1;
  }
  switch (random.below(8)) {
    case 0:
      return random.one_of({0U, 1U, 1968U, 1969U, 2000U, 2001U, 0xFFFFU});
    case 1:
      // On a model with only inputs or only outputs, a range that begins at the coil of a channel ends at the
      // last coil of the row, or one address after it.
      return module.row().inputs + module.row().outputs - (address & 0x1FU) % 16 + random.below(2);
    case 2:
      return random.between(1, 40);
    default:
      return random.between(1, 5);
  }
}

unsigned register_address(const Module& module, Random& random) {
  switch (random.below(14)) {
    case 0:
      return 0x3038 + random.below(2);
    case 1:
      return random.one_of({0x3037U, 0x01E0U, 0x01E1U, 0x01E6U, 0x01E7U, 0x01E9U, 0xFFFFU});
    case 2:
      return random.below(0x10000);
    case 3:
    case 4:
    case 5:
      return random.below(17);
    case 6:
    case 7:
    case 8:
    case 9:
      if (module.has_extensions()) {
        return extension_address(module, random);
      }
      [[fallthrough]];
    default:
      return random.one_of({0x01E2U, 0x01E3U, 0x01E4U, 0x01E5U, 0x01E8U, 0x01E8U});
  }
}

unsigned register_quantity(Random& random) {
  switch (random.below(8)) {
    case 0:
      return random.one_of({0U, 123U, 124U, 125U, 126U, 0xFFFFU});
    case 1:
      return random.between(1, 10);
    case 2:
    case 3:
      return 2;
    default:
      return 1;
  }
}

unsigned register_content(unsigned address, const Module& module, Random& random) {
  if (address >= 0x0240 && address < 0x0310) {
    return extension_content(module, address, random);
  }
  if (address == 0x01E8 && random.once_in(3)) {
    return random.one_of({0U, 0U, 256U});
  }
  if (module.has_extensions() && address == 0x01E5 && random.once_in(8)) {
    return random.one_of({0x40U, 0x42U, 0x4BU, 0x80U, 0x82U, 0x8BU, 0xC0U, 0xC2U, 0xCBU, 0x0143U, 0x8006U});
  }
  if (random.once_in(5)) {
    return random.one_of({0U, 1U, 2U, 3U, 0x0AU, 0x0BU, 247U, 248U, 255U, 256U, 0xFFFFU, 0x0103U});
  }
  switch (address) {
    case 0x01E4:
      return random.once_in(2) ? module.stored().address : random.between(1, 247);
    case 0x01E5:
      return random.once_in(2)
                 ? module.stored().baud_code
                 : baud_code_with(random.one_of({3U, 4U, 5U, 6U, 7U, 8U, 9U, 0x0AU, 0x0AU, 0x0AU}), module,
                                  random);
    default:
      return random.between(1, 24);
  }
}

/// Returns function code and data.
Bytes request(const Module& module, Random& random) {
  Bytes pdu;
  const unsigned coil = coil_address(module, random);
  const unsigned coils = coil_quantity(module, coil, random);
  const unsigned first = register_address(module, random);
  const unsigned registers = register_quantity(random);
  switch (random.below(30)) {
    case 0:
    case 1:
    case 2:
    case 3:
      pdu = {0x01};
      append_word(pdu, coil);
      append_word(pdu, coils);
      break;
    case 4:
    case 5:
      pdu = {0x02};
      append_word(pdu, random.once_in(8) ? coil : random.below(9));
      append_word(pdu, random.once_in(4) ? coils : random.between(1, 8));
      break;
    case 6:
    case 7:
    case 8:
    case 9:
      pdu = {random.one_of<std::uint8_t>({0x03, 0x03, 0x04})};
      append_word(pdu, first);
      append_word(pdu, registers);
      break;
    case 10:
      pdu = {random.one_of<std::uint8_t>({0x03, 0x04})};
      append_word(pdu, 0x3038);
      append_word(pdu, random.below(3));
      break;
    case 11:
    case 12:
    case 13:
    case 14:
    case 15:
      pdu = {0x05};
      append_word(pdu, coil);
      append_word(pdu, random.once_in(8) ? random.one_of({0x0001U, 0xFF01U, 0x00FFU, 0xFFFFU})
                                         : random.one_of({0xFF00U, 0xFF00U, 0x0000U}));
      break;
    case 16:
    case 17:
    case 18: {
      pdu = {0x0F};
      append_word(pdu, coil);
      append_word(pdu, coils);
      const unsigned bytes = std::min((coils + 7) / 8, 246U);
      pdu.push_back(static_cast<std::uint8_t>(bytes + (random.once_in(12) ? random.below(3) : 0)));
      for (unsigned i = 0; i < bytes; ++i) {
        pdu.push_back(any_byte(random));
      }
      break;
    }
    case 19:
    case 20:
    case 21:
      pdu = {0x06};
      append_word(pdu, first);
      append_word(pdu, register_content(first, module, random));
      break;
    case 22:
    case 23: {
      pdu = {0x10};
      append_word(pdu, first);
      append_word(pdu, registers);
      const unsigned words = std::min(registers, 123U);
      pdu.push_back(static_cast<std::uint8_t>(2 * words + (random.once_in(12) ? random.below(3) : 0)));
      for (unsigned i = 0; i < words; ++i) {
        append_word(pdu, register_content(first + i, module, random));
      }
      break;
    }
    case 24:
    case 25: {
      pdu = {0x08};
      const unsigned sub_function =
          random.once_in(8) ? random.below(0x0200)
                            : random.one_of({0x00U, 0x0AU, 0x0BU, 0x0CU, 0x0DU, 0x0EU, 0x0FU, 0x12U});
      append_word(pdu, sub_function);
      append_word(pdu, random.once_in(sub_function == 0 ? 1 : 8) ? random.below(0x10000) : 0);
      break;
    }
    case 26:
      pdu = {0x11};
      break;
    case 27:
      pdu = {0x2B, random.once_in(12) ? any_byte(random) : std::uint8_t{0x0E},
             static_cast<std::uint8_t>(random.below(6)),
             static_cast<std::uint8_t>(random.once_in(2) ? 0 : random.below(9))};
      break;
    case 28:
      pdu = {0x46, random.one_of<std::uint8_t>({0x00, 0x00, 0x04, 0x04, 0x04, 0x01, 0x05, 0xFF})};
      if (pdu[1] != 0x00) {
        const bool reserved = random.once_in(5);
        pdu.push_back(static_cast<std::uint8_t>(random.once_in(4)
                                                    ? random.one_of({0, 1, 247, 248, 255})
                                                    : static_cast<int>(module.stored().address)));
        for (unsigned i = 0; i < 3; ++i) {
          pdu.push_back(static_cast<std::uint8_t>(reserved ? random.below(2) : 0));
        }
      }
      break;
    default:
      pdu = {any_byte(random)};
      for (unsigned i = random.below(6); i != 0; --i) {
        pdu.push_back(any_byte(random));
      }
      break;
  }
  return pdu;
}

}  // namespace

Bytes modbus_request(const Module& module, Random& random) {
  Bytes frame = request(module, random);
  // Some requests are truncated or extended before the CRC is appended.
  if (random.once_in(25)) {
    frame.resize(random.below(static_cast<unsigned>(frame.size()) + 1));
  } else if (random.once_in(25)) {
    for (unsigned i = random.between(1, 3); i != 0; --i) {
      frame.push_back(any_byte(random));
    }
  } else if (random.once_in(200)) {
    frame.resize(random.between(248, 260), 0x55);
  }
  std::uint8_t address = static_cast<std::uint8_t>(module.address());
  if (random.once_in(10)) {
    address = 0;
  } else if (random.once_in(15)) {
    address = any_byte(random);
  }
  frame.insert(frame.begin(), address);
  frame = with_crc(frame);
  switch (random.below(60)) {
    case 0:
      frame[random.below(static_cast<unsigned>(frame.size()))] ^=
          static_cast<std::uint8_t>(1U << random.below(8));
      break;
    case 1:
      frame.resize(random.between(1, static_cast<unsigned>(frame.size())));
      break;
    case 2:
      frame.insert(frame.begin(), 0x00);
      break;
    case 3:
      frame.insert(frame.begin(), random.one_of<std::uint8_t>({0x01, 0xFF, 0x00}));
      frame.insert(frame.begin(), 0x00);
      break;
    case 4:
      frame.clear();
      for (unsigned i = random.between(1, 12); i != 0; --i) {
        frame.push_back(any_byte(random));
      }
      break;
    default:
      break;
  }
  return frame;
}

}  // namespace ex9000::reference
