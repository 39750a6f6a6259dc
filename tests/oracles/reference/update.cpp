// The update of the firmware: extensions.md, firmware update.
#include "tests/oracles/reference/update.hpp"

#include <algorithm>
#include <utility>

#include "tests/oracles/reference/modbus_refusal.hpp"
#include "tests/oracles/reference/module.hpp"

namespace ex9000::reference {

namespace {

constexpr unsigned kBlockSize = 128;
constexpr unsigned kSector = 4096;
constexpr unsigned kLongest = 126'976;
constexpr unsigned kSignature = 12;

unsigned long_word(const Bytes& bytes, std::size_t at) {
  return word(bytes, at) << 16U | word(bytes, at + 2);
}

}  // namespace

std::uint32_t crc32(const std::vector<std::uint8_t>& bytes, std::size_t count) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (std::size_t i = 0; i < count; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) {
      crc = crc >> 1U ^ (crc % 2 != 0 ? 0xEDB88320U : 0U);
    }
  }
  return ~crc;
}

unsigned Image::length() const { return begin.empty() ? 0 : long_word(begin, kSignature); }
unsigned Image::version() const { return begin.empty() ? 0x0100 : word(begin, kSignature + 4); }
bool Image::activates_when_complete() const { return begin[kSignature + 7] % 2 != 0; }

bool Image::contains(unsigned offset, const std::vector<std::uint8_t>& bytes) const {
  return offset < size() && std::equal(bytes.begin(), bytes.end(), content->begin() + offset);
}

bool Image::crc_is_right() const { return crc32(*content, length()) == long_word(begin, kSignature + 8); }

Update Update::erased() const {
  Update next;
  next.running = running;
  next.starts = starts;
  return next;
}

Update Update::after_reset() const {
  Update next = *this;
  next.activates = next.answered = false;
  next.periods = 0;
  switch (state) {
    case UpdateState::Receiving:
      if (spare.size() < kSector) {
        return erased();
      }
      if (spare.size() % kSector != 0) {
        Bytes kept = *spare.content;
        kept.resize(kept.size() / kSector * kSector);
        next.spare.content = std::make_shared<Bytes>(std::move(kept));
      }
      break;
    case UpdateState::Pending:
      std::swap(next.running, next.spare);
      next.state = UpdateState::Unconfirmed;
      break;
    case UpdateState::Unconfirmed:
      std::swap(next.running, next.spare);
      next.state = UpdateState::TakenBack;
      break;
    default:
      break;
  }
  return next;
}

/// The model without `EX` and `-`.
std::string Module::model_text() const {
  std::string text = std::string(row_->designation).substr(2);
  text.erase(std::remove(text.begin(), text.end(), '-'), text.end());
  return text;
}

/// Simulated modules are Picos.
std::string Module::signature() const { return model_text() + ".pico"; }

std::string Module::version_text() const {
  const unsigned version = update_.running.version();
  return "D" + hex(version >> 8, 2) + "." + hex(version, 2);
}

/// Register 0x1011 and 0x1012. The specification does not say what they are when no block is expected.
unsigned Module::next_offset() const {
  switch (update_.state) {
    case UpdateState::Receiving:
      return update_.spare.size();
    case UpdateState::Complete:
    case UpdateState::Pending:
    case UpdateState::TakenBack:
      return update_.spare.length();
    case UpdateState::Unconfirmed:
      return update_.running.length();
    default:
      return 0;
  }
}

void Module::begin_update(const Bytes& data) {
  Bytes own(kSignature);
  const std::string text = signature();
  std::copy(text.begin(), text.end(), own.begin());
  const unsigned length = long_word(data, kSignature);
  if (stored_.updates_allowed == 0) {
    throw Exception{0x04, "begin 04 not allowed"};
  }
  if (update_.state == UpdateState::Pending || update_.state == UpdateState::Unconfirmed) {
    throw Exception{0x04, "begin 04 state"};
  }
  if (!std::equal(own.begin(), own.end(), data.begin())) {
    throw Exception{0x04, "begin 04 signature"};
  }
  if (length == 0 || length > kLongest) {
    throw Exception{0x04, "begin 04 length"};
  }
  if ((word(data, kSignature + 6) & 0xFFFEU) != 0 ||
      std::any_of(data.begin() + kSignature + 12, data.end(), [](std::uint8_t byte) { return byte != 0; })) {
    throw Exception{0x04, "begin 04 reserved"};
  }
  const bool goes_on = update_.state == UpdateState::Receiving || update_.state == UpdateState::Complete;
  if (!goes_on || update_.spare.begin != data) {
    update_ = update_.erased();
    update_.spare.begin = data;
    update_.state = UpdateState::Receiving;
    update_.starts += 1;
  }
}

/// Returns why a block gets 03; empty: it does not.
std::string Module::block_refusal(unsigned offset, const Bytes& bytes, bool crc_is_right) const {
  if (!crc_is_right) {
    return "block 03 CRC";
  }
  if (offset % kBlockSize != 0) {
    return "block 03 offset";
  }
  switch (update_.state) {
    case UpdateState::Receiving:
      if (offset >= update_.spare.length()) {
        return "block 03 beyond the image";
      }
      if (offset > update_.spare.size()) {
        return "block 03 ahead";
      }
      return offset == update_.spare.size() || update_.spare.contains(offset, bytes) ? ""
                                                                                     : "block 03 other bytes";
    case UpdateState::Complete:
      return update_.spare.contains(offset, bytes) ? "" : "block 03 complete without it";
    case UpdateState::Unconfirmed:
      return update_.running.contains(offset, bytes) ? "" : "block 03 running without it";
    case UpdateState::Failed:
      return "";
    default:
      return "block 03 state";
  }
}

void Module::receive_block(const Bytes& data) {
  const unsigned offset = long_word(data, 0);
  const Bytes bytes(data.begin() + 4, data.begin() + 4 + kBlockSize);
  const std::string refusal =
      block_refusal(offset, bytes, crc32(data, 4 + kBlockSize) == long_word(data, 4 + kBlockSize));
  const bool fails = stored_.updates_allowed == 0 || update_.state == UpdateState::Failed;
  // The specification does not say which refusal comes first.
  if (!refusal.empty() && (!fails || choice(2) == 0)) {
    throw Exception{0x03, refusal};
  }
  if (fails) {
    throw Exception{0x04, stored_.updates_allowed == 0 ? "block 04 not allowed" : "block 04 flash"};
  }
  if (update_.state != UpdateState::Receiving || offset != update_.spare.size()) {
    return;  // it is there already
  }
  Image& image = update_.spare;
  Bytes content = image.content ? *image.content : Bytes();
  content.insert(content.end(), bytes.begin(), bytes.end());
  image.content = std::make_shared<Bytes>(std::move(content));
  programs_ = is_block_ = true;
  if (image.size() < image.length()) {
    return;
  }
  if (!image.crc_is_right()) {
    update_ = update_.erased();
    throw Exception{0x04, "block 04 CRC of the image"};
  }
  update_.state = UpdateState::Complete;
  update_.activates = image.activates_when_complete();
}

/// Register 0x1013.
void Module::judge_update_action(unsigned value) const {
  const UpdateState state = update_.state;
  switch (value) {
    case 1:
      if (state != UpdateState::Complete || stored_.updates_allowed == 0) {
        throw Exception{0x04, "activate 04"};
      }
      break;
    case 2:
      if (state != UpdateState::Unconfirmed) {
        throw Exception{0x04, "confirm 04"};
      }
      break;
    case 3:
      if (state != UpdateState::Receiving && state != UpdateState::Complete) {
        throw Exception{0x04, "abandon 04"};
      }
      break;
    default:
      throw Exception{0x03, "register 0x1013 03"};
  }
}

void Module::act_on_update(unsigned value) {
  programs_ = true;
  if (value == 1) {
    update_.state = UpdateState::Pending;
  } else if (value == 2) {
    confirm_update();
  } else {
    update_ = update_.erased();
  }
}

void Module::confirm_update() { update_ = update_.erased(); }

void Module::end_update_period() {
  if (update_.answered) {
    confirm_update();
  } else {
    update_.periods += 1;
  }
}

}  // namespace ex9000::reference
