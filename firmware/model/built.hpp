// The models that are built into a program: all of them in the simulator, exactly one in a firmware image.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "firmware/model/model.hpp"

namespace ex9000 {

// kBuiltInputs: the largest number of inputs of all built models.

#ifdef EX9000_MODEL

/// The model of this image. EX9000_MODEL is a designation, for example "EX9042D-M".
inline constexpr Model kOnlyModel = *find_model(EX9000_MODEL);

/// The model of a module. It stores nothing, because the model is a compile-time constant.
class ChosenModel {
 public:
  explicit constexpr ChosenModel(const Model& /*model*/) {}
  [[nodiscard]] static constexpr const Model& get() { return kOnlyModel; }
};

constexpr bool some_model_meets(Needs needs) { return meets(kOnlyModel, needs); }
constexpr unsigned kBuiltInputs = kOnlyModel.inputs;

#else

/// The model of a module, a row of kModels.
class ChosenModel {
 public:
  explicit constexpr ChosenModel(const Model& model) : model_(&model) {}
  [[nodiscard]] constexpr const Model& get() const { return *model_; }

 private:
  const Model* model_;
};

constexpr bool some_model_meets(Needs /*needs*/) { return true; }
constexpr unsigned kBuiltInputs = kMaxInputs;

#endif

/// Returns whether `model` has what a row needs. Always true in an image, which contains only matching rows.
constexpr bool has(const Model& model, Needs needs) {
#ifdef EX9000_MODEL
  static_cast<void>(model);
  static_cast<void>(needs);
  return true;
#else
  return meets(model, needs);
#endif
}

/// True if a built model can speak Modbus. If false, the program contains no code for Modbus RTU.
constexpr bool kBuiltModbus = some_model_meets(Needs::Modbus);

/// Returns the member `part` of each row of `table`, without the rows that no built model has.
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
