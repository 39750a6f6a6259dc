// The layouts in which earlier firmware stored the settings.
#pragma once

#include <cstddef>
#include <optional>

#include "firmware/bytes.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/record.hpp"

namespace ex9000 {

/// A copy of layout 1 or 2 is within one page of the memory. All numbers have the low byte first. The check
/// is `settings_check` over all bytes before it.
///
///     layout 1                        layout 2
///     0       layout, 1               0       address
///     1-2     sequence                1       baud code
///     3       address                 2       format
///     4       baud code               3       protocol
///     5       format                  4       watchdog timeout
///     6       protocol                5       watchdog enabled, 0 or 1
///     7       bit 0 watchdog enabled  6       timeout status, 0 or 1
///             bit 1 timeout status    7       0
///     8       watchdog timeout        8-14    name, padded with 0
///     9-10    power-on value          15      length of the name
///     11-12   safe value              16-17   power-on value
///     13      length of the name      18-19   safe value
///     14-20   name, padded with 0     20-21   sequence
///                                     22-23   layout, 2
///     21-24   check                   24-27   check
constexpr std::size_t kOldCopySize = 28;

/// Zeros in the bytes from kOldInvalidatedFrom on, which include the check, make a copy of either layout
/// invalid.
constexpr std::size_t kOldInvalidatedFrom = 20;
constexpr std::size_t kOldInvalidatedSize = kOldCopySize - kOldInvalidatedFrom;

/// Returns the settings and their edition if `page`, which must have at least kOldCopySize bytes, begins with
/// a good copy of either layout: the layout number and the check are correct, and the model could have stored
/// these settings. Otherwise returns nothing.
std::optional<StoredSettings> read_old_layout(const Model& model, Bytes page);

}  // namespace ex9000
