#include "hal/doubles/memory.hpp"

#include <algorithm>

#include "firmware/expect.hpp"

namespace ex9000::hal::doubles {

void Memory::begin(bool writing, std::uint16_t address, std::size_t size) {
  EX9000_EXPECT(!busy());
  EX9000_EXPECT(address + size <= kSize);
  EX9000_EXPECT(!writing || address / kPage == (address + size - 1) / kPage);
  // A read transfers the device address twice and a memory address of two bytes; a write, the device address
  // only once, but it takes the same time here.
  constexpr std::int64_t kAddressing = 4;
  writing_ = writing;
  address_ = address;
  ends_ = clock_.virtual_now() + kByteOnBus * (static_cast<std::int64_t>(size) + kAddressing) +
          (writing ? kProgram : VirtualTime(0));
}

void Memory::start_read(std::uint16_t address, MutableBytes destination, Time /*now*/) {
  begin(false, address, destination.size);
  destination_ = destination;
}

void Memory::start_write(std::uint16_t address, Bytes source, Time /*now*/) {
  begin(true, address, source.size);
  source_ = source;
  ++writes_;
}

void Memory::run() {
  if (ends_ > clock_.virtual_now()) {
    return;
  }
  ends_ = kNever;
  succeeded_ = !failing_;
  if (failing_) {
    return;
  }
  if (writing_) {
    std::copy(source_.begin(), source_.end(), contents_.begin() + address_);
    succeeded_ = kept(source_.size);
    if (succeeded_ && written_) {
      written_();
    }
  } else {
    std::copy_n(contents_.begin() + address_, destination_.size, destination_.data);
  }
}

void Memory::cut() {
  if (busy() && writing_ && !failing_) {
    const VirtualTime programming_began = ends_ - kProgram;
    const VirtualTime had = std::max(clock_.virtual_now() - programming_began, VirtualTime(0));
    const auto done = static_cast<std::size_t>(had * static_cast<std::int64_t>(source_.size) / kProgram);
    std::copy_n(source_.begin(), done, contents_.begin() + address_);
    if (had != VirtualTime(0) && done < source_.size) {
      constexpr std::uint8_t kHalfErased = 0xA5;
      contents_[address_ + done] |= kHalfErased;
    }
    kept(std::min(done + 1, source_.size));
  }
  ends_ = kNever;
}

bool Memory::kept(std::size_t size) { return !keep_ || keep_(address_, {contents_.data() + address_, size}); }

}  // namespace ex9000::hal::doubles
