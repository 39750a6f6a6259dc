// The models in a program: one, EX9000_MODEL, in a firmware image; else all of them, as in the simulator.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "firmware/model/model.hpp"

namespace ex9000 {

#ifdef EX9000_NO_IMAGE_SLOTS
constexpr bool kHasImageSlots = false;
#else
constexpr bool kHasImageSlots = true;
#endif

// `some_model_meets`: whether a built model has the property `needs`. ChosenVersion: of the running image.

#ifdef EX9000_MODEL

/// EX9000_MODEL: a designation, e.g. "EX9042D-M".
inline constexpr Model kOnlyModel = *find_model(EX9000_MODEL);

/// Stores nothing, because the model is a compile-time constant.
class ChosenModel {
 public:
  explicit constexpr ChosenModel(const Model& /*model*/) {}
  [[nodiscard]] static constexpr const Model& get() { return kOnlyModel; }
};

constexpr bool some_model_meets(Needs needs) {
  return meets(kOnlyModel, needs) && (kHasImageSlots || needs != Needs::ImageSlots);
}

struct ChosenVersion {
  [[nodiscard]] static constexpr std::string_view text() { return kFirmwareVersion; }
  static void pretend(std::uint16_t /*digits*/) {}
};

#else

class ChosenModel {
 public:
  explicit constexpr ChosenModel(const Model& model) : model_(&model) {}
  [[nodiscard]] constexpr const Model& get() const { return *model_; }

 private:
  const Model* model_;
};

constexpr bool some_model_meets(Needs /*needs*/) { return true; }

/// A simulated module that has been updated has another version.
class ChosenVersion {
 public:
  [[nodiscard]] std::string_view text() const { return {text_.data(), text_.size()}; }
  /// `digits`: nn.nn in BCD.
  void pretend(std::uint16_t digits) {
    constexpr std::array<unsigned, 4> kPlaces{1, 2, 4, 5};
    constexpr unsigned kBitsOfADigit = 4;
    for (unsigned i = 0; i < kPlaces.size(); ++i) {
      const unsigned digit = digits >> (kBitsOfADigit * (kPlaces.size() - 1 - i)) & 0xFU;
      text_[kPlaces[i]] = static_cast<char>('0' + digit);
    }
  }

 private:
  std::array<char, kFirmwareVersion.size()> text_ = [] {
    std::array<char, kFirmwareVersion.size()> text{};
    for (std::size_t i = 0; i < text.size(); ++i) {
      text[i] = kFirmwareVersion[i];
    }
    return text;
  }();
};

#endif

/// Whether `model` meets the `needs` of a table row. Always true with EX9000_MODEL, because the program then
/// contains only the rows whose needs the model meets.
constexpr bool has(const Model& model, Needs needs) {
#ifdef EX9000_MODEL
  static_cast<void>(model);
  static_cast<void>(needs);
  return true;
#else
  return meets(model, needs);
#endif
}

/// If false, the compiler removes the code for updates.
constexpr bool kBuiltUpdate = some_model_meets(Needs::ImageSlots);
/// If false, the compiler removes the code for Modbus RTU frames.
constexpr bool kBuiltModbus = some_model_meets(Needs::Modbus);

/// The member `part` of each row of `table`, without the rows whose `needs` no built model meets.
template <const auto& table, auto part>
constexpr auto rows_of_built_models() {
  constexpr std::size_t kCount = [] {
    std::size_t count = 0;
    for (const auto& row : table) {
      count += some_model_meets((row.*part).needs) ? 1U : 0U;
    }
    return count;
  }();
  std::array<std::decay_t<decltype(table[0].*part)>, kCount> rows{};
  std::size_t next = 0;
  for (const auto& row : table) {
    if (some_model_meets((row.*part).needs)) {
      rows[next++] = row.*part;
    }
  }
  return rows;
}

}  // namespace ex9000
