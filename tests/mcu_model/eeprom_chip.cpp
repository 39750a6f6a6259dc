#include "tests/mcu_model/eeprom_chip.hpp"

#include <algorithm>

namespace ex9000::registers {

namespace {

constexpr std::uint8_t kDevice = 0xA0;  // A2, A1 and A0 are connected to GND

}  // namespace

EepromChip::EepromChip(Timeline& timeline, Net& clock, Net& data, std::vector<std::uint8_t>& contents)
    : timeline_(timeline), clock_(clock), data_(data), contents_(contents), programmed_(timeline, [this] {
        commit(order_.size());
        programmed_pages_.push_back({order_.front(), order_.size(), began_});
        tell();
      }) {
  clock_.drive(End::Resistor, Drive::WeakHigh);
  data_.drive(End::Resistor, Drive::WeakHigh);
  clock_.on_change([this] { clock_changed(); });
  data_.on_change([this] { data_changed(); });
}

void EepromChip::remove(bool pull_ups_too) {
  lose_power();
  step_ = Step::Off;
  if (pull_ups_too) {
    clock_.drive(End::Resistor, Drive::Nothing);
    data_.drive(End::Resistor, Drive::Nothing);
  }
}

void EepromChip::lose_power() {
  if (programmed_.is_set()) {
    const auto part =
        (timeline_.now() - began_) * static_cast<std::int64_t>(order_.size()) / programming_time_;
    const auto whole = static_cast<std::size_t>(part);
    commit(whole);
    if (whole < order_.size()) {
      std::uint8_t& spoiled = contents_.at(order_[whole]);
      spoiled = static_cast<std::uint8_t>(spoiled ^ 0x5AU);
    }
    programmed_.cancel();
  }
  step_ = step_ == Step::Off ? Step::Off : Step::Idle;
  acknowledging_ = false;
  pull(false);
}

std::vector<EepromChip::Cell> EepromChip::being_programmed() const {
  std::vector<Cell> cells;
  if (programming()) {
    for (const std::uint16_t place : order_) {
      cells.push_back({place, page_.at(place % kPage)});
    }
  }
  return cells;
}

void EepromChip::commit(std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    program(order_[i], page_.at(order_[i] % kPage));
  }
}

void EepromChip::program(std::uint16_t place, std::uint8_t value) {
  std::uint8_t kept = value;
  if (const auto worn = worn_.find(place); worn != worn_.end()) {
    const auto [bits, stuck] = worn->second;
    kept = static_cast<std::uint8_t>((value & ~bits) | (stuck & bits));
  }
  spoiled_ += kept != value ? 1U : 0U;
  contents_.at(place) = kept;
}

/// Processes START and STOP, which are changes of the data line while the clock is high.
void EepromChip::data_changed() {
  data_level_ = data_.level();
  if (!clock_level_ || step_ == Step::Off) {
    return;
  }
  if (!data_level_) {
    step_ = Step::Addressed;
    bit_ = 0;
    byte_ = 0;
    bytes_ = 0;
    acknowledging_ = false;
    pull(false);
    tell();
    return;
  }
  // Only a STOP immediately after the acknowledge of a whole byte programs a page.
  if (step_ == Step::Writing && bit_ == 1 && !order_.empty()) {
    begin_programming();
  }
  step_ = Step::Idle;
  acknowledging_ = false;
  pull(false);
  tell();
}

void EepromChip::begin_programming() {
  began_ = timeline_.now();
  std::vector<std::uint16_t> once;
  for (const std::uint16_t place : order_) {
    if (std::find(once.begin(), once.end(), place) == once.end()) {
      once.push_back(place);
    }
  }
  order_ = once;
  programmed_.set_after(programming_time_);
}

void EepromChip::clock_changed() {
  clock_level_ = clock_.level();
  if (step_ == Step::Idle || step_ == Step::Off) {
    return;
  }
  if (clock_level_) {
    // A bit is read while the clock is high.
    if (acknowledging_) {
      return;
    }
    if (step_ == Step::Reading && bit_ == 8) {
      // If the master does not acknowledge a byte, the chip sends no more bytes.
      if (data_level_) {
        step_ = Step::Idle;
        return;
      }
    }
    if (step_ != Step::Reading) {
      byte_ = static_cast<std::uint8_t>(unsigned{byte_} << 1U | (data_level_ ? 1U : 0U));
    }
    ++bit_;
    return;
  }
  if (step_ == Step::Reading && !acknowledging_) {
    put_next_bit();
    return;
  }
  if (acknowledging_) {
    acknowledging_ = false;
    bit_ = 0;
    byte_ = 0;
    pull(false);
    if (step_ == Step::Reading) {
      put_next_bit();
    }
    return;
  }
  if (bit_ == 8) {
    byte_taken();
    tell();
  }
}

void EepromChip::put_next_bit() {
  if (bit_ == 8) {
    pull(false);  // so that the master can acknowledge
    tell();
    return;
  }
  if (bit_ == 0 || bit_ == 9) {
    bit_ = 0;
    byte_ = contents_.at(address_);
    address_ = static_cast<std::uint16_t>((address_ + 1U) % kSize);
  }
  pull((byte_ >> (7 - bit_) & 1U) == 0);
}

void EepromChip::byte_taken() {
  const bool take = ++bytes_ <= patience_;
  switch (step_) {
    case Step::Addressed:
      if ((byte_ & 0xFEU) != kDevice) {
        step_ = Step::Idle;
        return;
      }
      if (programming()) {
        ++polls_refused_;
        step_ = Step::Idle;
        return;
      }
      step_ = (byte_ & 1U) != 0 ? Step::Reading : Step::AddressHigh;
      order_.clear();
      break;
    case Step::AddressHigh:
      address_ = static_cast<std::uint16_t>((unsigned{byte_} << 8U | (address_ & 0xFFU)) % kSize);
      step_ = Step::AddressLow;
      break;
    case Step::AddressLow:
      address_ = static_cast<std::uint16_t>((address_ & 0xFF00U) | byte_);
      step_ = Step::Writing;
      break;
    case Step::Writing:
      // At the end of a page, the address wraps to the beginning of the page.
      if (take) {
        page_.at(address_ % kPage) = byte_;
        order_.push_back(address_);
        address_ = static_cast<std::uint16_t>((address_ & ~(kPage - 1U)) | ((address_ + 1U) % kPage));
      }
      break;
    case Step::Reading:
    case Step::Idle:
    case Step::Off:
      return;
  }
  if (!take) {
    step_ = Step::Idle;
    return;
  }
  acknowledging_ = true;
  pull(true);
}

}  // namespace ex9000::registers
