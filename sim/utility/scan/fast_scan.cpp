#include "sim/utility/scan/fast_scan.hpp"

#include <algorithm>
#include <optional>

#include "firmware/line/crc16.hpp"
#include "firmware/line/rtu_frames.hpp"

namespace ex9000::utility {

namespace {

enum class Round { Silent, Disturbed, Found, NobodyLeft };

struct RoundResult {
  Round round = Round::Silent;
  Scanned module{};
};

/// Of a round: its windows, then the reply.
Time longest_round(hal::SerialMode mode, Time latency) {
  constexpr int kBitsOfRequest = 5 * 12;
  constexpr int kBitsBefore = 42;
  constexpr int kBitsOfReply = 10 * 12;
  constexpr int kWindows = 32;
  constexpr int kBitsOfWindow = 13;
  const Time bit = Time(std::chrono::seconds(1)) / mode.baud;
  const Time window =
      std::max<Time>(bit * kBitsOfWindow, bit * kBitsOfWindow + std::chrono::microseconds(50));
  const Time before = std::max<Time>(bit * kBitsBefore, std::chrono::microseconds(800) + bit);
  return bit * (kBitsOfRequest + kBitsOfReply) + before + window * kWindows + latency;
}

/// The frame with this sub-function, if it is in what was heard.
std::optional<Bytes> frame_in(const Data& heard, std::uint8_t subfunction, std::size_t size) {
  const Data begin{modbus::kScanAddress, modbus::kScanFunction, subfunction};
  const auto at = std::search(heard.begin(), heard.end(), begin.begin(), begin.end());
  if (static_cast<std::size_t>(heard.end() - at) < size || crc16({&*at, size}).value() != 0) {
    return std::nullopt;
  }
  return Bytes{&*at, size};
}

RoundResult round(MasterLine& line, std::uint8_t subfunction, Time latency) {
  constexpr std::size_t kFoundSize = 10;
  constexpr std::size_t kNobodySize = 5;
  constexpr std::size_t kNumberAt = 3;
  constexpr std::size_t kAddressAt = 7;
  Connection& connection = line.connection();
  Data request{modbus::kScanAddress, modbus::kScanFunction, subfunction};
  append_crc(request);
  connection.send(request);
  const Time end = connection.now() + longest_round(line.mode(), latency);
  Data heard;
  for (Data more; !(more = connection.receive(end - connection.now())).empty();) {
    heard.insert(heard.end(), more.begin(), more.end());
    if (const auto found = frame_in(heard, modbus::kFound, kFoundSize)) {
      return {Round::Found, {found->double_word(kNumberAt), (*found)[kAddressAt]}};
    }
    if (frame_in(heard, modbus::kNobodyLeft, kNobodySize)) {
      return {Round::NobodyLeft};
    }
  }
  return {heard_of(heard, request) == Heard::Noise ? Round::Disturbed : Round::Silent};
}

}  // namespace

std::vector<Scanned> fast_scan(MasterLine& line, Time latency) {
  constexpr unsigned kScans = 4;
  constexpr unsigned kMostRounds = 1000;
  std::vector<Scanned> found;
  for (unsigned i = 0; i < kScans; ++i) {
    RoundResult heard = round(line, modbus::kFirstRound, latency);
    for (unsigned rounds = 0; heard.round == Round::Found && rounds < kMostRounds; ++rounds) {
      const auto known = std::find_if(found.begin(), found.end(), [&](const Scanned& each) {
        return each.serial_number == heard.module.serial_number;
      });
      if (known == found.end()) {
        found.push_back(heard.module);
      }
      heard = round(line, modbus::kNextRound, latency);
    }
    if (heard.round == Round::NobodyLeft || (heard.round == Round::Silent && found.empty())) {
      break;
    }
  }
  return found;
}

}  // namespace ex9000::utility
