// The update over the line - extensions.md, firmware update.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/model.hpp"
#include "firmware/request/refusal.hpp"
#include "firmware/settings/crc32.hpp"
#include "firmware/time.hpp"
#include "firmware/update/request.hpp"
#include "firmware/update/signature.hpp"
#include "firmware/update/slot.hpp"
#include "firmware/update/slot_job.hpp"

namespace ex9000::update {

/// Register 0x1010.
enum class State : std::uint8_t {
  None,
  Receiving,
  Complete,     ///< and verified
  Activating,   ///< the module must be reset into the new image
  Unconfirmed,  ///< the running image has not proved itself
  TakenBack,    ///< the newer image did not prove itself
  FlashFailed,
};

/// Receives an image into the spare slot, and confirms the running one. What a slot says survives a power
/// failure; a transfer then continues at the beginning of a sector, because a block that was being programmed
/// may read right and still not last.
///
/// For the main loop; nothing blocks. The owner judges a request, accepts it, and calls `poll` in every pass
/// until it is answered. While `busy()`, it carries out `job()`, then calls `done()`.
class Update {
 public:
  void start(const Origin& origin, const Model& model);

  // --- registers ---

  [[nodiscard]] State state() const { return state_; }
  /// Offset of the next block in the image, in bytes.
  [[nodiscard]] std::uint32_t next() const { return next_; }
  [[nodiscard]] const Signature& signature() const { return signature_; }

  // --- requests, one at a time ---

  /// `allowed`: register 0x0254.
  [[nodiscard]] Refusal judge(const Request& request, bool allowed) const;
  /// Of a request that `judge` has not refused. Copies the data.
  void accept(const Request& request, Time now);
  [[nodiscard]] bool answered() const { return asked_ == Ask::Nothing; }
  /// Of the last request that was answered.
  [[nodiscard]] Refusal answer() const { return answer_; }
  [[nodiscard]] Deadline latest_answer() const { return answered() ? Deadline() : latest_answer_; }

  /// If it is Unconfirmed.
  void proved() { proved_ = true; }

  // --- jobs of the slots ---

  void poll(Time now);
  [[nodiscard]] bool busy() const { return step_ != Step::Idle; }
  /// Only while `busy()`. Stays the same until `done`.
  [[nodiscard]] const SlotJob& job() const { return job_; }
  void done();

 private:
  enum class Step : std::uint8_t {
    Idle,
    Secure,    ///< marks the running image as confirmed once more, before the other one goes: see slot.hpp
    Withdraw,  ///< programs zeros over the beginning of the header: an erase that the power ends is none
    EraseHeader,
    WriteHeader,
    Compare,  ///< a block that has been received before
    EraseSector,
    WriteBlock,
    MarkSector,
    Verify,
    MarkActivated,
    MarkConfirmed,
  };
  // Each step that programs also reads back.

  [[nodiscard]] Refusal judge_begin(Bytes data) const;
  [[nodiscard]] Refusal judge_block(Bytes data) const;
  void begin(Bytes info);
  void discard(State state);
  void answer_with(Refusal refusal);
  [[nodiscard]] Step due() const;
  void begin_step(Step step);
  void begin_mark(std::uint32_t mark);
  void begin_job(SlotJob::Kind kind, std::uint32_t offset, Bytes source);
  void finish(Step step, bool good);
  void succeed(Step step);
  void fail(Step step);
  void verify();

  State state_ = State::None;
  Signature signature_{};
  std::uint8_t running_ = 0;    ///< slot of the running image
  std::uint8_t slot_ = 1;       ///< of the image in `info_`; the running one only while it is Unconfirmed
  std::uint32_t sequence_ = 0;  ///< of a new image
  Info info_;
  std::uint32_t next_ = 0;
  std::uint32_t marked_ = 0;    ///< sectors with their mark
  std::uint32_t erased_ = 0;    ///< sectors from the first one on that are erased or written
  std::uint32_t verified_ = 0;  ///< bytes
  Crc32 crc_;

  bool secured_ = true;  ///< the mark of the running image lasts
  bool withdraw_ = false;
  bool header_erased_ = false;
  bool header_written_ = false;
  bool proved_ = false;

  Ask asked_ = Ask::Nothing;
  Refusal answer_ = Refusal::None;
  Deadline latest_answer_;
  bool block_waits_ = false;    ///< `block_` has not been written or compared yet
  std::uint32_t block_at_ = 0;  ///< its offset in the image

  Step step_ = Step::Idle;
  bool stale_ = false;  ///< the step that is running belongs to an image that counts no more
  SlotJob job_;
  Header header_{};
  std::array<std::uint8_t, kBlockSize> block_{};
  std::array<std::uint8_t, kBlockSize> read_{};
};

}  // namespace ex9000::update
