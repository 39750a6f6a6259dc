// A master that scans a virtual line, written from the public description of the protocol.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <tuple>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/text/values.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

class ScanMaster {
 public:
  using Bytes = std::vector<std::uint8_t>;
  struct Found {
    std::uint32_t serial_number;
    unsigned address;

    friend bool operator<(Found a, Found b) { return a.serial_number < b.serial_number; }
    friend bool operator==(Found a, Found b) {
      return std::tie(a.serial_number, a.address) == std::tie(b.serial_number, b.address);
    }
    friend std::ostream& operator<<(std::ostream& out, Found found) {
      return out << hex_long_text(found.serial_number) << " at " << found.address;
    }
  };

  /// At the rate and in the format of the first module.
  explicit ScanMaster(const std::vector<ModuleSpec>& modules, LineKind kind = kPaced)
      : line_(modules, kind, [this](std::uint8_t byte, ByteStatus /*status*/) { heard_.push_back(byte); }) {
    line_.come_up();
    line_.master().set_mode(line_.module(0).mode());
  }

  Line& line() { return line_; }

  /// Instead of a time that is long enough for all: from the end of a reply to the next request.
  VirtualTime gap{0};
  /// Called after each round.
  std::function<void()> between = [] {};
  /// A round without a right reply is repeated a few times, then the scan ends.
  bool tolerant = false;

  /// All that arrives within the time of an arbitration, a reply and a silence.
  Bytes round(std::uint8_t subfunction) {
    if (gap == VirtualTime(0)) {
      return ask({0xFD, 0x46, subfunction}, 900);
    }
    const Bytes request = with_crc({0xFD, 0x46, subfunction});
    heard_.clear();
    line_.master().send(request.data(), request.size());
    for (unsigned tries = 0; frame_of(heard_).empty() && tries < 10000; ++tries) {
      line_.wires().run_for(std::chrono::microseconds(50));
    }
    line_.wires().run_for(gap);
    return heard_;
  }

  /// Until nobody is left.
  std::vector<Found> scan() {
    std::vector<Found> found;
    unsigned failed = 0;
    for (std::uint8_t next = 0x01;; next = 0x02) {
      const Bytes reply = frame_of(round(next));
      between();
      if (reply == Bytes{0xFD, 0x46, 0x04}) {
        return found;
      }
      if (reply.size() != 8 || reply[0] != 0xFD || reply[1] != 0x46 || reply[2] != 0x03) {
        if (tolerant && ++failed < 10) {
          continue;
        }
        EXPECT_TRUE(tolerant) << "not a reply to a round: " << hex_text(reply, " ");
        return found;
      }
      found.push_back({reply[3] * 0x1000000U + reply[4] * 0x10000U + reply[5] * 0x100U + reply[6], reply[7]});
    }
  }

  /// Sends `request` with its CRC, and lets the time of `bits` pass after it. What has arrived.
  Bytes ask(const Bytes& request, std::int64_t bits) { return put(with_crc(request), bits); }
  Bytes put(const Bytes& frame, std::int64_t bits) {
    heard_.clear();
    line_.master().send(frame.data(), frame.size());
    const VirtualTime bit(1'000'000'000 / line_.master().mode().baud);
    line_.wires().run_for(line_.master().takes(frame.size()) + bits * bit + std::chrono::microseconds(1750));
    return heard_;
  }

  /// Without the bytes of the arbitration before it, which may be damaged, and without its CRC; empty if that
  /// is wrong.
  static Bytes frame_of(Bytes heard) {
    const Bytes begin{0xFD, 0x46};
    if (const auto scan = std::search(heard.begin(), heard.end(), begin.begin(), begin.end());
        scan != heard.end()) {
      heard.erase(heard.begin(), scan);
    }
    if (heard.size() < 4) {
      return {};
    }
    Bytes frame(heard.begin(), heard.end() - 2);
    return with_crc(frame) == heard ? frame : Bytes{};
  }

 private:
  Bytes heard_;
  Line line_;
};

}  // namespace ex9000::sim
