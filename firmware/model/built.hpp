// Which models a program can be: the simulator all of them, a firmware image the one it is built for.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "firmware/model/model.hpp"

namespace ex9000 {

// kBuiltInputs: the most inputs that one of them has.

#ifdef EX9000_MODEL

/// The image's own; EX9000_MODEL is a designation such as "EX9042D-M".
inline constexpr Model kOnlyModel = *find_model(EX9000_MODEL);

/// The model a module is; nothing is stored, and what depends on it is decided by the compiler.
class ChosenModel {
 public:
  explicit constexpr ChosenModel(const Model& /*model*/) {}
  [[nodiscard]] static constexpr const Model& get() { return kOnlyModel; }
};

constexpr bool some_model_meets(Needs needs) { return meets(kOnlyModel, needs); }
constexpr unsigned kBuiltInputs = kOnlyModel.inputs;

#else

/// The model a module is; a row of kModels.
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

/// Whether `model` has what a row needs; all rows of an image were chosen for it.
constexpr bool has(const Model& model, Needs needs) {
#ifdef EX9000_MODEL
  static_cast<void>(model);
  static_cast<void>(needs);
  return true;
#else
  return meets(model, needs);
#endif
}

/// Whether a module of this program may speak Modbus; else none of it is built in.
constexpr bool kBuiltModbus = some_model_meets(Needs::Modbus);

/// The part of each row of `table` that `part` points to, without those that no model of this program has.
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
