// A word that a reset by the watchdog or after a fault does not change. Any other reset may.
//     std::uint32_t load() const
//     void store(std::uint32_t value)     In each pass of the main loop; does not block.
#pragma once
