// An Update on two slots in RAM. A test decides when a job ends and what it does.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "firmware/update/boot.hpp"
#include "firmware/update/update.hpp"
#include "tests/firmware/update/messages.hpp"

namespace ex9000::update {

/// The contents of both slots: what `choose` needs, and an image in slot 0 at first.
struct Slots {
  Slots() {
    const Buffer image = image_of(1000, 77);
    const Buffer bytes = info_of(image, 0x0100);
    Info info;
    std::copy(bytes.begin(), bytes.end(), info.bytes.begin());
    const Header header = header_of(info, 1);
    cells[0].assign(kImageAt, 0);
    std::copy(header.begin(), header.end(), cells[0].begin());
    cells[0].insert(cells[0].end(), image.begin(), image.end());
    cells[0].resize(kSlotSize, 0xFF);
    cells[1].assign(kSlotSize, 0xFF);
  }

  [[nodiscard]] SlotHead head(unsigned slot) const {
    SlotHead head{};
    std::copy_n(cells[slot].begin(), head.size(), head.begin());
    return head;
  }
  [[nodiscard]] bool load(unsigned slot, const Info& info) const {
    return info.length() != 0 && info.length() <= kLargestImage &&
           crc32({&cells[slot][kImageAt], info.length()}) == info.check();
  }
  bool mark_tried(unsigned slot) {
    if (marks) {
      cells[slot][kMarksAt + kTried] = kMarked;
    }
    return marks;
  }

  Buffer cells[kSlots];
  bool marks = true;  ///< a mark can be programmed
};

class Bench {
 public:
  explicit Bench(Slots slots = {}) : slots_(std::move(slots)) { reset(); }

  /// The boot loader, then a module.
  void reset() {
    update_ = Update();
    const auto chosen = choose(slots_);
    running_ = chosen.value();
    const auto head_0 = slots_.head(0);
    const auto head_1 = slots_.head(1);
    update_.start({static_cast<std::uint8_t>(running_),
                   kTestBoard,
                   {Bytes{head_0.data(), head_0.size()}, Bytes{head_1.data(), head_1.size()}}},
                  the_model());
    run();
  }

  [[nodiscard]] const Update& update() const { return update_; }
  Update& update() { return update_; }
  [[nodiscard]] unsigned running() const { return running_; }
  Slots& slots() { return slots_; }
  Buffer& spare() { return slots_.cells[1 - running_]; }

  /// Judges, accepts and carries out. Returns None or the refusal.
  Refusal ask(Ask what, const Buffer& data = {}) {
    const Request request{what, {data.data(), data.size()}};
    const Refusal refusal = update_.judge(request, true);
    if (refusal != Refusal::None) {
      return refusal;
    }
    update_.accept(request, now);
    run();
    EXPECT_TRUE(update_.answered() || holds);
    return update_.answer();
  }
  Refusal begin(const Buffer& image, std::uint16_t version = 0x0101, std::uint16_t flags = 0) {
    return ask(Ask::Begin, info_of(image, version, flags));
  }
  Refusal block(const Buffer& image, std::uint32_t offset) {
    return ask(Ask::Block, block_of(image, offset));
  }
  /// From the next block on. Stops at a refusal.
  Refusal blocks(const Buffer& image, std::uint32_t until = kLargestImage) {
    Refusal refusal = Refusal::None;
    while (refusal == Refusal::None && update_.next() < std::min<std::size_t>(until, image.size())) {
      refusal = block(image, update_.next());
    }
    return refusal;
  }

  /// Until nothing is left to do, or a job `holds`.
  void run() {
    for (;;) {
      update_.poll(now);
      if (!update_.busy() || holds) {
        return;
      }
      end_job();
    }
  }
  void end_job() {
    const SlotJob& job = update_.job();
    Buffer& cells = slots_.cells[job.slot];
    ++jobs;
    switch (job.kind) {
      case SlotJob::Kind::Erase:
        EXPECT_EQ(job.offset % kSector, 0U);
        std::fill_n(cells.begin() + job.offset, kSector, 0xFF);
        break;
      case SlotJob::Kind::Program:
        EXPECT_EQ(job.offset / 256, (job.offset + job.source.size - 1) / 256);
        for (std::size_t i = 0; !fails && i < job.source.size; ++i) {
          cells[job.offset + i] &= job.source[i];
        }
        break;
      case SlotJob::Kind::Read:
        std::copy_n(cells.begin() + job.offset, job.destination.size, job.destination.data);
        break;
    }
    update_.done();
  }

  Time now{1000};
  bool holds = false;  ///< jobs do not end by themselves
  bool fails = false;  ///< program operations change nothing
  unsigned jobs = 0;   ///< that have ended

 private:
  Slots slots_;
  unsigned running_ = 0;
  Update update_;
};

}  // namespace ex9000::update
