// Fuzzes -M models with bytes, gaps, line errors and other events. The models use Modbus unless the input
// selects ASCII. For the input format see byte_code.hpp; byte 0 selects the model.
#include "tests/fuzz/byte_code.hpp"

namespace {

using ex9000::Model;

const Model& chosen(std::uint8_t number) {
  constexpr unsigned kSpeakModbus = [] {
    unsigned count = 0;
    for (const Model& model : ex9000::kModels) {
      count += model.speaks_modbus() ? 1U : 0U;
    }
    return count;
  }();
  unsigned left = number % kSpeakModbus;
  for (const Model& model : ex9000::kModels) {
    if (model.speaks_modbus() && left-- == 0) {
      return model;
    }
  }
  return ex9000::kModels[0];
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size != 0) {
    ex9000::fuzz::live(chosen(data[0]), ex9000::Protocol::ModbusRtu, data, size);
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
  return ex9000::fuzz::mutate(data, size, most, seed, true);
}
