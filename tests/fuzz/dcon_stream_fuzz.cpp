// Fuzzes all models with characters, pauses, line errors and other events. -M models use ASCII unless the
// input selects Modbus. For the input format see byte_code.hpp; byte 0 selects the model.
#include "tests/fuzz/byte_code.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size != 0) {
    const ex9000::Model& model = ex9000::kModels[data[0] % std::size(ex9000::kModels)];
    ex9000::fuzz::live(model, ex9000::Protocol::Ascii, data, size);
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
  return ex9000::fuzz::mutate(data, size, most, seed, false);
}
