#include "hal/doubles/image_slots.hpp"

#include <algorithm>

#include "firmware/expect.hpp"
#include "firmware/update/signature.hpp"

namespace ex9000::hal::doubles {

using namespace update;

namespace {

constexpr std::uint8_t kErased = 0xFF;

}  // namespace

ImageSlots::ImageSlots(const VirtualClock& clock, const Model& model) : clock_(clock) {
  constexpr std::array<std::uint8_t, 4> kImage{kErased, kErased, kErased, kErased};  // so takes no memory
  const Signature signature = signature_of(model, kBoard);
  const std::uint16_t version = version_in_bcd();
  const std::uint32_t check = crc32({kImage.data(), kImage.size()});
  Info info;
  const auto put = [&info](std::size_t offset, std::uint32_t value, unsigned bytes) {
    for (unsigned i = 0; i < bytes; ++i) {
      info.bytes[offset + i] = static_cast<std::uint8_t>(value >> (8U * (bytes - 1 - i)));
    }
  };
  std::copy(signature.begin(), signature.end(), info.bytes.begin());
  put(kLengthAt, kImage.size(), 4);
  put(kVersionAt, version, 2);
  put(kImageCheckAt, check, 4);
  const Header header = header_of(info, 1);
  std::vector<std::uint8_t>& slot = contents_[0];
  slot.assign(kSlotHeadSize, kMarked);
  std::copy(header.begin(), header.end(), slot.begin());
}

// --- the boot loader ---

bool ImageSlots::boot() {
  const std::optional<unsigned> chosen = choose(*this);
  running_ = chosen.value_or(0);
  for (unsigned slot = 0; slot < kSlots; ++slot) {
    heads_[slot] = head(slot);
  }
  return chosen.has_value();
}

std::uint16_t ImageSlots::version() const {
  return Slot({heads_[running_].data(), kSlotHeadSize}).info.version();
}

bool ImageSlots::unconfirmed() const { return !Slot({heads_[running_].data(), kSlotHeadSize}).confirmed; }

SlotHead ImageSlots::head(unsigned slot) const {
  SlotHead head{};
  for (std::uint32_t i = 0; i < head.size(); ++i) {
    head[i] = at(slot, i);
  }
  return head;
}

bool ImageSlots::load(unsigned slot, const Info& info) const {
  if (info.length() == 0 || info.length() > kLargestImage) {
    return false;
  }
  Crc32 crc;
  for (std::uint32_t i = 0; i < info.length(); ++i) {
    crc.add(at(slot, kImageAt + i));
  }
  return crc.value() == info.check();
}

bool ImageSlots::mark_tried(unsigned slot) {
  program(slot, kMarksAt + kTried, {&kMarked, 1});
  return at(slot, kMarksAt + kTried) == kMarked;
}

// --- jobs ---

Origin ImageSlots::origin() const {
  Origin origin{static_cast<std::uint8_t>(running_), kBoard, {}};
  for (unsigned slot = 0; slot < kSlots; ++slot) {
    origin.heads[slot] = {heads_[slot].data(), heads_[slot].size()};
  }
  return origin;
}

void ImageSlots::start(const SlotJob& job, Time /*now*/) {
  EX9000_EXPECT(!busy());
  using Kind = SlotJob::Kind;
  job_ = job;
  ends_ = clock_.virtual_now() + (job.kind == Kind::Erase     ? kErase
                                  : job.kind == Kind::Program ? kProgram
                                                              : VirtualTime(0));
}

void ImageSlots::run() {
  if (ends_ > clock_.virtual_now()) {
    return;
  }
  ends_ = kNever;
  switch (job_.kind) {
    case SlotJob::Kind::Erase:
      erase(job_.slot, job_.offset, 0);
      break;
    case SlotJob::Kind::Program:
      program(job_.slot, job_.offset, job_.source);
      break;
    case SlotJob::Kind::Read:
      for (std::uint32_t i = 0; i < job_.destination.size; ++i) {
        job_.destination.data[i] = at(job_.slot, job_.offset + i);
      }
      break;
  }
}

void ImageSlots::cut() {
  if (busy() && job_.kind == SlotJob::Kind::Erase) {
    constexpr std::uint8_t kNotYetErased = 0x5A;
    erase(job_.slot, job_.offset, kNotYetErased);
  } else if (busy() && job_.kind == SlotJob::Kind::Program) {
    program(job_.slot, job_.offset, job_.source.first(job_.source.size / 2));
  }
  ends_ = kNever;
}

std::uint8_t ImageSlots::at(unsigned slot, std::uint32_t offset) const {
  const std::vector<std::uint8_t>& bytes = contents_[slot];
  return offset < bytes.size() ? bytes[offset] : kErased;
}

void ImageSlots::program(unsigned slot, std::uint32_t offset, Bytes bytes) {
  std::vector<std::uint8_t>& all = contents_[slot];
  if (failing_) {
    return;
  }
  if (all.size() < offset + bytes.size) {
    all.resize(offset + bytes.size, kErased);
  }
  for (std::size_t i = 0; i < bytes.size; ++i) {
    all[offset + i] &= bytes[i];
  }
}

/// `kept_bits`: of each byte, as after an erase that was interrupted.
void ImageSlots::erase(unsigned slot, std::uint32_t offset, std::uint8_t kept_bits) {
  std::vector<std::uint8_t>& all = contents_[slot];
  const std::size_t end = std::min<std::size_t>(all.size(), offset + kSector);
  for (std::size_t i = offset; i < end; ++i) {
    all[i] = static_cast<std::uint8_t>(all[i] | ~kept_bits);
  }
}

}  // namespace ex9000::hal::doubles
