// What a receiver makes of bytes that were sent at another rate.
#pragma once

#include <cstdint>
#include <vector>

namespace ex9000::rig {

/// The rates are of one kind: they differ by no more than UARTs bear.
bool same_rate(std::uint32_t a, std::uint32_t b);

/// `bytes`, sent without a gap at `sent_at` bits per second, as a receiver at `heard_at` samples them. 8N1;
/// framing errors are left out of what is returned, since an emulated UART cannot be given any, but the bytes
/// they came with are in it.
std::vector<std::uint8_t> heard_at_rate(const std::vector<std::uint8_t>& bytes, std::uint32_t sent_at,
                                        std::uint32_t heard_at);

}  // namespace ex9000::rig
