#include "firmware/settings/old_layouts.hpp"

namespace ex9000 {

namespace {

bool has_check(const Model& model, Bytes page, std::size_t at) {
  return page.low_byte_first_32(at) == settings_check(model, page.first(at));
}

/// Returns the name at `at`. If `length` is too large, returns an empty name, which no model could have
/// stored.
Name name_at(Bytes page, std::size_t at, std::size_t length) {
  return Name(page.from(at).first(length <= kMaxNameLength ? length : 0));
}

StoredSettings read_layout_1(Bytes page) {
  constexpr std::uint8_t kEnabled = 0x01;
  constexpr std::uint8_t kTimeoutStatus = 0x02;
  StoredSettings stored;
  stored.edition = {1, page.low_byte_first_16(1)};
  Settings& settings = stored.settings;
  settings.address = page[3];
  settings.baud_code = page[4];
  settings.format = page[5];
  settings.protocol = static_cast<Protocol>(page[6]);
  settings.watchdog_enabled = (page[7] & kEnabled) != 0;
  settings.timeout_status = (page[7] & kTimeoutStatus) != 0;
  settings.watchdog_timeout = page[8];
  settings.power_on_value = page.low_byte_first_16(9);
  settings.safe_value = page.low_byte_first_16(11);
  settings.name = name_at(page, 14, page[13]);
  return stored;
}

StoredSettings read_layout_2(Bytes page) {
  StoredSettings stored;
  stored.edition = {2, page.low_byte_first_16(20)};
  Settings& settings = stored.settings;
  settings.address = page[0];
  settings.baud_code = page[1];
  settings.format = page[2];
  settings.protocol = static_cast<Protocol>(page[3]);
  settings.watchdog_timeout = page[4];
  settings.watchdog_enabled = page[5] != 0;
  settings.timeout_status = page[6] != 0;
  settings.name = name_at(page, 8, page[15]);
  settings.power_on_value = page.low_byte_first_16(16);
  settings.safe_value = page.low_byte_first_16(18);
  return stored;
}

}  // namespace

std::optional<StoredSettings> read_old_layout(const Model& model, Bytes page) {
  constexpr std::size_t kCheckOf1 = 21;
  constexpr std::size_t kCheckOf2 = 24;
  StoredSettings stored;  // layout 0, which does not exist
  if (page.low_byte_first_16(22) == 2 && (page[5] | page[6]) <= 1 && has_check(model, page, kCheckOf2)) {
    stored = read_layout_2(page);
  } else if (page[0] == 1 && has_check(model, page, kCheckOf1)) {
    stored = read_layout_1(page);
  }
  const bool good = stored.edition.layout != 0 && stored.settings.possible_for(model);
  return good ? std::optional(stored) : std::nullopt;
}

}  // namespace ex9000
