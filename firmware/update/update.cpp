#include "firmware/update/update.hpp"

#include <algorithm>

#include "firmware/expect.hpp"

namespace ex9000::update {

namespace {

/// For a request that the flash keeps waiting (extensions.md, firmware update).
constexpr Duration kLongestWait = milliseconds(400);
constexpr std::array<std::uint8_t, 1> kMark{kMarked};

bool equal(Bytes a, Bytes b) { return std::equal(a.begin(), a.end(), b.begin()); }

}  // namespace

// --- at a reset ---

void Update::start(const Origin& origin, const Model& model) {
  const Slot running(origin.heads[origin.slot]);
  running_ = origin.slot;
  slot_ = 1U - origin.slot;
  const Slot spare(origin.heads[slot_]);
  signature_ = signature_of(model, origin.board);
  sequence_ = running.sequence + 1;
  secured_ = !running.valid;
  if (running.valid && !running.confirmed) {
    state_ = State::Unconfirmed;
    slot_ = running_;
    info_ = running.info;
    next_ = info_.length();
  } else if (spare.valid && spare.sequence == sequence_ && spare.sectors != 0) {
    // Without a sector, the power may have failed during the header.
    info_ = spare.info;
    marked_ = spare.sectors;
    erased_ = spare.sectors;
    next_ = std::min(marked_ * kSector, info_.length());
    header_written_ = true;
    // If it has been activated, the boot loader has not started it now. One of its marks may have decayed.
    state_ = spare.activated || spare.tried ? State::TakenBack : State::Receiving;
  }
}

// --- requests ---

Refusal Update::judge(const Request& request, bool allowed) const {
  const bool receives = state_ == State::Receiving || state_ == State::Complete;
  switch (request.ask) {  // not covered: the enumeration has no other value
    case Ask::Begin:
      return allowed ? judge_begin(request.data) : Refusal::UpdateRefused;
    case Ask::Block:
      return allowed ? judge_block(request.data) : Refusal::UpdateRefused;
    case Ask::Activate:
      return allowed && state_ == State::Complete ? Refusal::None : Refusal::UpdateRefused;
    case Ask::Confirm:
      return state_ == State::Unconfirmed ? Refusal::None : Refusal::UpdateRefused;
    case Ask::Abandon:
    case Ask::Nothing:  // not covered: a request asks for something
      break;
  }
  return receives ? Refusal::None : Refusal::UpdateRefused;
}

Refusal Update::judge_begin(Bytes data) const {
  Info info;
  std::copy_n(data.begin(), kInfoSize, info.bytes.begin());
  const Bytes reserved = info.reserved();
  const bool right =
      equal(info.signature(), {signature_.data(), signature_.size()}) && info.length() != 0 &&
      info.length() <= kLargestImage && (info.flags() & ~kActivateWhenComplete) == 0 &&
      std::all_of(reserved.begin(), reserved.end(), [](std::uint8_t byte) { return byte == 0; });
  // While the running image is not confirmed, the other slot has the image to go back to.
  const bool free = state_ != State::Unconfirmed && state_ != State::Activating;
  return right && free ? Refusal::None : Refusal::UpdateRefused;
}

Refusal Update::judge_block(Bytes data) const {
  if (data.double_word(kBlockCheckAt) != crc32(data.first(kBlockCheckAt))) {
    return Refusal::WrongValue;
  }
  // A request that the flash has kept waiting too long may have left work that still needs the block.
  const bool in_use = step_ == Step::WriteBlock || step_ == Step::Compare;
  if (state_ == State::FlashFailed || in_use) {
    return Refusal::UpdateRefused;
  }
  const std::uint32_t offset = data.double_word(0);
  const bool begun = state_ == State::Receiving || state_ == State::Complete || state_ == State::Unconfirmed;
  return begun && offset % kBlockSize == 0 && offset < info_.length() && offset <= next_
             ? Refusal::None
             : Refusal::WrongValue;
}

void Update::accept(const Request& request, Time now) {
  EX9000_EXPECT(answered());
  asked_ = request.ask;
  answer_ = Refusal::None;
  latest_answer_.set(now + kLongestWait);
  if (asked_ == Ask::Begin) {
    begin(request.data);
    asked_ = Ask::Nothing;  // the reply does not wait for the flash
  } else if (asked_ == Ask::Block) {
    block_waits_ = true;
    block_at_ = request.data.double_word(0);
    std::copy_n(request.data.begin() + kBlockDataAt, kBlockSize, block_.begin());
  } else if (asked_ == Ask::Abandon) {
    discard(State::None);
  }
}

void Update::begin(Bytes info) {
  const bool same = equal(info.first(kInfoSize), info_.all());
  if (same && (state_ == State::Receiving || state_ == State::Complete)) {
    return;
  }
  std::copy_n(info.begin(), kInfoSize, info_.bytes.begin());
  header_ = header_of(info_, sequence_);
  discard(State::Receiving);
}

/// Nothing in the spare slot counts from now on.
void Update::discard(State state) {
  state_ = state;
  next_ = 0;
  marked_ = 0;
  erased_ = 0;
  verified_ = 0;
  block_waits_ = false;
  header_erased_ = false;
  header_written_ = false;
  withdraw_ = true;
  stale_ = step_ != Step::Idle;
}

void Update::answer_with(Refusal refusal) {
  if (!answered()) {
    answer_ = refusal;
    asked_ = Ask::Nothing;
  }
}

// --- the steps ---

void Update::poll(Time now) {
  if (!busy()) {
    begin_step(due());
  }
  if (!busy()) {
    answer_with(Refusal::None);  // nothing is left to do
  } else if (!answered() && latest_answer_.reached(now)) {
    answer_with(Refusal::UpdateRefused);  // the work goes on, so a repeated request finds it done
  }
}

Update::Step Update::due() const {
  const bool received = next_ >= info_.length();
  if (withdraw_) {
    return secured_ ? Step::Withdraw : Step::Secure;
  }
  switch (state_) {
    case State::Receiving:
      if (!header_written_) {
        return header_erased_ ? Step::WriteHeader : Step::EraseHeader;
      }
      if (marked_ < (received ? sectors_of(next_) : next_ / kSector)) {
        return Step::MarkSector;
      }
      break;
    case State::Complete:
      if (asked_ == Ask::Activate || (info_.flags() & kActivateWhenComplete) != 0) {
        return Step::MarkActivated;
      }
      break;
    case State::Unconfirmed:
      if (asked_ == Ask::Confirm || proved_) {
        return Step::MarkConfirmed;
      }
      break;
    default:
      break;
  }
  if (block_waits_) {
    return block_at_ < next_                ? Step::Compare
           : block_at_ / kSector >= erased_ ? Step::EraseSector
                                            : Step::WriteBlock;
  }
  return state_ == State::Receiving && received ? Step::Verify : Step::Idle;
}

void Update::begin_step(Step step) {
  using Kind = SlotJob::Kind;
  const std::uint32_t block = kImageAt + block_at_;
  step_ = step;
  switch (step) {  // not covered: the enumeration has no other value
    case Step::Idle:
      break;
    case Step::Secure:
      begin_mark(kConfirmed);
      job_.slot = running_;
      break;
    case Step::Withdraw:
      withdraw_ = false;
      begin_job(Kind::Program, 0, {kNoMagic.data(), kNoMagic.size()});
      break;
    case Step::EraseHeader:
      begin_job(Kind::Erase, 0, {});
      break;
    case Step::WriteHeader:
      begin_job(Kind::Program, 0, {header_.data(), header_.size()});
      break;
    case Step::Compare:
      begin_job(Kind::Read, block, {block_.data(), block_.size()});
      break;
    case Step::EraseSector:
      begin_job(Kind::Erase, block - block % kSector, {});
      break;
    case Step::WriteBlock:
      begin_job(Kind::Program, block, {block_.data(), block_.size()});
      break;
    case Step::MarkSector:
      begin_mark(marked_);
      break;
    case Step::Verify:
      begin_job(Kind::Read, kImageAt + verified_, {});
      break;
    case Step::MarkActivated:
      begin_mark(kActivated);
      break;
    case Step::MarkConfirmed:
      proved_ = false;
      begin_mark(kConfirmed);
      break;
  }
}

void Update::begin_mark(std::uint32_t mark) {
  begin_job(SlotJob::Kind::Program, kMarksAt + mark, {kMark.data(), kMark.size()});
}

/// `source`: what is programmed, or what a read should find.
void Update::begin_job(SlotJob::Kind kind, std::uint32_t offset, Bytes source) {
  job_ = {kind, slot_, offset, source, {read_.data(), read_.size()}};
}

void Update::done() {
  EX9000_EXPECT(busy());
  if (job_.kind == SlotJob::Kind::Program && !stale_) {
    job_.kind = SlotJob::Kind::Read;
    return;
  }
  const Step step = step_;
  step_ = Step::Idle;
  if (!stale_) {
    finish(step, job_.kind == SlotJob::Kind::Erase || equal(job_.source, {read_.data(), read_.size()}));
  }
  stale_ = false;
}

void Update::finish(Step step, bool good) {
  if (step == Step::Verify) {
    verify();
  } else if (good) {
    succeed(step);
  } else {
    fail(step);
  }
}

void Update::succeed(Step step) {
  switch (step) {
    case Step::Secure:
      secured_ = true;
      break;
    case Step::EraseHeader:
      header_erased_ = true;
      break;
    case Step::WriteHeader:
      header_written_ = true;
      break;
    case Step::Compare:
      block_waits_ = false;
      break;
    case Step::EraseSector:
      ++erased_;
      break;
    case Step::WriteBlock:
      block_waits_ = false;
      next_ = std::min(block_at_ + kBlockSize, info_.length());
      break;
    case Step::MarkSector:
      ++marked_;
      break;
    case Step::MarkActivated:
      state_ = State::Activating;
      break;
    case Step::MarkConfirmed:
      secured_ = true;
      state_ = State::None;
      slot_ = 1U - running_;
      next_ = 0;
      break;
    default:
      break;
  }
}

/// What has been read back is wrong.
void Update::fail(Step step) {
  if (step == Step::Compare) {
    block_waits_ = false;
    answer_with(Refusal::WrongValue);
    return;
  }
  answer_with(Refusal::UpdateRefused);
  if (step == Step::MarkConfirmed) {
    return;  // `proved` tries again; the other image must stay
  }
  if (state_ != State::FlashFailed) {
    discard(State::FlashFailed);
  }
  withdraw_ = withdraw_ && step != Step::Secure;
}

/// The piece that has been read.
void Update::verify() {
  const std::uint32_t size = std::min(kBlockSize, info_.length() - verified_);
  if (verified_ == 0) {
    crc_ = Crc32();
  }
  for (std::uint32_t i = 0; i < size; ++i) {
    crc_.add(read_[i]);
  }
  verified_ += size;
  if (verified_ != info_.length()) {
    return;
  }
  if (crc_.value() == info_.check()) {
    state_ = State::Complete;
  } else {
    discard(State::None);
    answer_with(Refusal::UpdateRefused);
  }
}

}  // namespace ex9000::update
