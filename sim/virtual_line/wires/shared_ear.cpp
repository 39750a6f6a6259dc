#include "sim/virtual_line/wires/shared_ear.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "firmware/hex.hpp"
#include "firmware/line/rtu_frames.hpp"

namespace ex9000::sim {

namespace {

/// What begins a frame of DCON, or the reply of a module.
constexpr std::string_view kDconLeads = "#$%@~!>?";

}  // namespace

SharedEar::SharedEar(const VirtualClock& clock, const Hearing& hearing, Leave leave)
    : clock_(clock), hearing_(hearing), leave_(std::move(leave)) {
  begin_anew();
}

void SharedEar::begin_anew() {
  assembler_.emplace();
  assembler_->rtu.use(hearing_.timing);
  assembler_->dcon.use_checksum(hearing_.checksum);
  // A frame with this address is for no module in Modbus. It concerns all, which is more than necessary.
  constexpr std::uint8_t kNobody = 0xFF;
  assembler_->rtu.answer_to(kNobody);
  assembler_->dcon.answer_to(kNobody);
}

bool SharedEar::hears_like(const Hearing& hearing) const {
  return hearing.protocol == hearing_.protocol && hearing.checksum == hearing_.checksum &&
         hearing.baud_code == hearing_.baud_code;
}

void SharedEar::add(std::size_t station, std::uint8_t address) {
  members_.push_back({station, name_of(address), heard_.verdicts});
}

Heard SharedEar::remove(std::size_t station) {
  const auto member = std::find_if(members_.begin(), members_.end(),
                                   [=](const Member& each) { return each.station == station; });
  Heard missed = heard_;
  for (std::size_t verdict = 0; verdict < missed.verdicts.size(); ++verdict) {
    missed.verdicts[verdict] -= member->counted_then[verdict];
  }
  *member = members_.back();
  members_.pop_back();
  if (members_.empty()) {  // it hears nothing any more
    begin_anew();
    heard_ = {};
  }
  return missed;
}

void SharedEar::dissolve() {
  while (!members_.empty()) {
    leave_(members_.back().station);
  }
}

/// A DCON receiver ignores bytes between frames that begin none, and those past the longest frame.
bool SharedEar::matters(std::uint8_t byte) const {
  return heard_.frame.empty() ? kDconLeads.find(static_cast<char>(byte)) != std::string_view::npos
                              : heard_.frame.size() < kLongestDconFrame + 2U;
}

void SharedEar::hear(std::uint8_t byte) {
  constexpr std::size_t kMostKept = 300;  // longer than any frame
  if (heard_.frame.size() >= kMostKept) {
    dissolve();
    return;
  }
  if (heard_.silence_ends <= clock_.virtual_now()) {
    end_silence();  // before the receive interrupt, see hal/one_shot_timer.hpp
    if (members_.empty()) {
      return;
    }
  }
  Assembler& assembler = *assembler_;
  if (modbus()) {
    const Duration wait = assembler.rtu.byte(assembler.queue, byte, ByteStatus::Good);
    if (assembler.rtu.asks_for_round()) {
      dissolve();
      return;
    }
    heard_.frame.push_back(byte);
    heard_.silence_ends = clock_.when(wait);
  } else if (byte == DconAssembler::kEnd) {
    judge(assembler.dcon.end(assembler.queue, ByteStatus::Good, clock_.now_in_interrupt()));
  } else {
    assembler.dcon.byte(assembler.queue, byte, ByteStatus::Good);
    if (matters(byte)) {
      heard_.frame.push_back(byte);
    }
  }
}

void SharedEar::end_silence() {
  Assembler& assembler = *assembler_;
  const Verdict verdict = assembler.rtu.silence(assembler.queue, clock_.now_in_interrupt());
  const Duration wait = assembler.rtu.next_wait();
  if (verdict == Verdict::Open && !(wait == Duration())) {
    heard_.frame.push_back(Heard::kSilence);
    heard_.silence_ends = clock_.when(wait);
  } else {
    judge(verdict);
  }
}

/// As it stands in a frame.
std::uint32_t SharedEar::name_of(std::uint8_t address) const {
  return modbus() ? address : hex_digits(address);
}

/// In ascending order, at least the members whose verdict may differ from the ear's, or does more than count.
std::vector<std::size_t> SharedEar::concerned_by(Verdict verdict) const {
  std::vector<std::size_t> concerned;
  if (verdict == Verdict::Accepted || verdict == Verdict::HostOk || verdict == Verdict::NoRoom) {
    for (const Member& member : members_) {
      concerned.push_back(member.station);
    }
  } else if (verdict == Verdict::Foreign && heard_.frame.size() > 2) {
    const auto& frame = heard_.frame;
    // Modbus: a 00 may be of the turn-around, and a silence may follow it. DCON: after the delimiter.
    const auto second = std::find_if(frame.begin() + 1, frame.end(),
                                     [](std::uint16_t each) { return each != Heard::kSilence; });
    const std::uint32_t name = !modbus()       ? frame[1] | unsigned{frame[2]} << 8U
                               : frame[0] != 0 ? frame[0]
                                               : *second;
    for (const Member& member : members_) {
      if (member.name == name || name == modbus::kScanAddress) {
        concerned.push_back(member.station);
      }
    }
  }
  std::sort(concerned.begin(), concerned.end());
  return concerned;
}

/// Members that the frame concerns leave first.
void SharedEar::judge(Verdict verdict) {
  for (const std::size_t station : concerned_by(verdict)) {
    leave_(station);
  }
  if (members_.empty()) {
    return;
  }
  heard_.frame.clear();
  heard_.silence_ends = kNever;
  if (verdict != Verdict::Open) {
    ++heard_.verdicts[static_cast<std::size_t>(verdict)];
  }
}

}  // namespace ex9000::sim
