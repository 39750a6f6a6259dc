// Settings as they lie in the memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/bytes.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {

/// One copy of the settings. It fits one page of the EEPROM (32 bytes on an AT24C64), so that one page write
/// stores it.
///
///     0      layout, 1
///     1-2    sequence, low byte first: the copy with the later one counts
///     3      address
///     4      baud code
///     5      format
///     6      protocol
///     7      bit 0 host watchdog enabled, bit 1 timeout status
///     8      host watchdog timeout
///     9-10   power-on value, low byte first
///     11-12  safe value
///     13     length of the name
///     14-20  name, filled up with 0
///     21-24  CRC-32 over the model's designation and bytes 0 to 20, low byte first
///
/// The CRC begins with the designation, so that what another model has written never counts: its power-on
/// value was meant for other outputs.
constexpr std::size_t kRecordSize = 25;
using Record = std::array<std::uint8_t, kRecordSize>;

struct StoredSettings {
  Settings settings;
  std::uint16_t sequence = 0;
};

Record encode_record(const Model& model, const StoredSettings& stored);

/// Nothing where layout or CRC is wrong, or where the model could not have stored this.
std::optional<StoredSettings> decode_record(const Model& model, const Record& record);

/// Whether the memory was never written here: an erased EEPROM reads all FF.
bool is_blank(const Record& record);

}  // namespace ex9000
