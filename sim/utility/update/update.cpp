#include "sim/utility/update/update.hpp"

#include <utility>

#include "firmware/model/model.hpp"
#include "firmware/update/request.hpp"
#include "sim/text/fail.hpp"
#include "sim/utility/modbus/register_map.hpp"

namespace ex9000::utility {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using update::State;

constexpr unsigned kSignatureRegister = registers_of("update-signature");
constexpr unsigned kSignatureWords = size_of("update-signature");
constexpr unsigned kUpdatesAllowedRegister = registers_of("updates-allowed");
constexpr unsigned kVersionRegister = registers_of("version");
constexpr unsigned kBeginRegister = registers_of("update-begin");
constexpr unsigned kStateRegister = registers_of("update-state");  // then the next offset, high word first
constexpr unsigned kActionRegister = registers_of("update-action");
constexpr unsigned kBlockRegister = registers_of("update-block");

constexpr std::uint8_t kBadValue = 3;
constexpr std::uint8_t kFailed = 4;
constexpr std::uint8_t kBusy = 6;

constexpr seconds kPatienceForBegin{5};
constexpr unsigned kTries = 4;
/// Of a block that is refused because the flash is still working: a refusal may come at once.
constexpr unsigned kBlockTries = 40;
constexpr unsigned kReadyPolls = 50;
constexpr milliseconds kReadyPause{200};
constexpr unsigned kConfirmedPolls = 90;
constexpr seconds kConfirmedPause{1};

constexpr const char* kAgain = "; start again";

std::string state_text(State state) {
  constexpr const char* kTexts[] = {"none",        "receiving",  "complete",    "activation pending",
                                    "unconfirmed", "taken back", "flash failed"};
  const auto number = static_cast<unsigned>(state);
  return std::to_string(number) +
         (number < std::size(kTexts) ? " (" + std::string(kTexts[number]) + ")" : "");
}

[[noreturn]] void fail(const std::string& text) { throw Failed(text); }

}  // namespace

ModuleUpdate::ModuleUpdate(Module module, const UpdateFile& file)
    : module_(std::move(module)), file_(file), info_(file.info) {
  // The module activates only on request, so that several modules can do so together.
  info_.bytes[update::kFlagsAt + 1] &= static_cast<std::uint8_t>(~update::kActivateWhenComplete);
}

void ModuleUpdate::prepare() {
  const std::string signature = read(kSignatureRegister, kSignatureWords).text();
  if (signature != file_.signature()) {
    fail("has the signature '" + signature + "'; the file is for '" + file_.signature() + "'");
  }
  const State state = progress().state;
  if (state == State::Activating || state == State::Unconfirmed) {
    fail("still tries an image; start again in a minute, when it has confirmed that one");
  }
}

void ModuleUpdate::send(const Show& show) {
  unsigned tries = 0;
  do {
    if (tries++ == kTries) {
      fail("refuses its blocks; restart it, and start again");
    }
    begin();
  } while (!send_blocks(show));
  if (state_after(State::Receiving, kReadyPolls, kReadyPause) != State::Complete) {
    fail(std::string("has all blocks, but not a complete image") + kAgain);
  }
  show(info_.length(), info_.length());
}

void ModuleUpdate::begin() {
  const Answer answer = module_.ask(write_words(kBeginRegister, info_.all()), kPatienceForBegin);
  if (answer.exception == kFailed && read(kUpdatesAllowedRegister, 1).word(0) == 0) {
    fail("permits no updates; write 1 to register 0x0254 while INIT* is active");
  }
  if (answer.refused()) {
    fail("refuses the update: " + exception_text(answer.exception));
  }
}

/// false: the module has forgotten that the update has begun, as it does at a reset.
bool ModuleUpdate::send_blocks(const Show& show) {
  for (std::size_t number = progress().next / update::kBlockSize; number < file_.blocks.size(); ++number) {
    show(static_cast<std::uint32_t>(number * update::kBlockSize), info_.length());
    const Data& block = file_.blocks[number];
    Answer answer;
    for (unsigned tries = 0; tries < kBlockTries; ++tries) {
      answer = module_.ask(write_words(kBlockRegister, {block.data(), block.size()}));
      if (answer.exception != kFailed && answer.exception != kBusy) {
        break;
      }
      const State state = progress().state;
      if (state != State::Receiving && state != State::Complete) {
        break;
      }
    }
    if (answer.exception == kBadValue) {
      return false;
    }
    if (answer.refused()) {
      fail("refuses the block at " + std::to_string(number * update::kBlockSize) + ": " +
           exception_text(answer.exception) + ", in the state " + state_text(progress().state) +
           "; start again, and replace the board if that does not help");
    }
  }
  return true;
}

void ModuleUpdate::activate() {
  const auto answer =
      module_.try_once(write_word(kActionRegister, static_cast<std::uint16_t>(update::Ask::Activate)));
  if (answer && answer->refused()) {
    fail("refuses to activate the image: " + exception_text(answer->exception) + kAgain);
  }
}

void ModuleUpdate::wait_until_it_runs() {
  State state = State::Complete;
  for (unsigned tries = 0; state == State::Complete && tries < kTries; ++tries) {
    if (tries != 0) {
      activate();
    }
    state = state_after(State::Activating, kReadyPolls, kReadyPause);
  }
  check_version(state, true);
}

void ModuleUpdate::wait_until_confirmed() {
  check_version(state_after(State::Unconfirmed, kConfirmedPolls, kConfirmedPause), false);
}

void ModuleUpdate::check_version(State state, bool may_be_unconfirmed) {
  const std::string runs = version_text(read(kVersionRegister, 1).word(0));
  if (state == State::TakenBack) {
    fail("has taken the image back and runs " + runs + ": it did not prove itself");
  }
  if ((state != State::None && (state != State::Unconfirmed || !may_be_unconfirmed)) ||
      runs != file_.version()) {
    fail("runs " + runs + ", in the state " + state_text(state) + kAgain);
  }
}

/// The state as soon as it is not `passing`. No reply may mean that the module starts.
State ModuleUpdate::state_after(State passing, unsigned polls, Time pause) {
  bool answered = false;
  for (unsigned i = 0; i < polls; ++i) {
    module_.pause(pause);
    const auto answer = module_.try_once(read_words(kStateRegister, 1));
    if (answer && !answer->refused()) {
      answered = true;
      if (static_cast<State>(answer->word(0)) != passing) {
        return static_cast<State>(answer->word(0));
      }
    }
  }
  if (!answered) {
    fail("gives no reply any more; start again when it answers");
  }
  return passing;
}

ModuleUpdate::Progress ModuleUpdate::progress() {
  const Answer answer = read(kStateRegister, 3);
  return {static_cast<State>(answer.word(0)), Bytes{answer.data.data(), answer.data.size()}.double_word(2)};
}

Answer ModuleUpdate::read(unsigned address, unsigned count) {
  Answer answer = module_.ask(read_words(address, count));
  if (answer.refused()) {
    fail("refuses to read the registers of updates: " + exception_text(answer.exception) +
         "; its firmware or its board permits no update over the line");
  }
  return answer;
}

}  // namespace ex9000::utility
