#include "firmware/settings/places.hpp"

namespace ex9000 {

std::size_t copy_size(const Place& place, Bytes first_page) {
  return place.old ? kOldCopySize : record_size(first_page);
}

std::optional<StoredSettings> read_copy(const Model& model, const Place& place, Bytes copy) {
  return place.old ? read_old_layout(model, copy) : read_record(model, copy);
}

bool is_blank(Bytes bytes) {
  for (const std::uint8_t byte : bytes) {
    if (byte != 0xFF) {
      return false;
    }
  }
  return true;
}

}  // namespace ex9000
