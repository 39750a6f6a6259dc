#include "firmware/update/signature.hpp"

#include <gtest/gtest.h>

#include <iterator>
#include <set>
#include <string>

namespace ex9000::update {

namespace {

std::string text_of(const std::array<std::uint8_t, kSignatureSize>& signature) {
  return {signature.begin(), signature.end()};
}

}  // namespace

TEST(Signature, NamesModelAndBoard) {
  static_assert(signature_of(kModels[1], "pico")[0] == '9');
  EXPECT_EQ(text_of(signature_of(*find_model("EX9042D-M"), "pico")), std::string("9042DM.pico\0", 12));
  EXPECT_EQ(text_of(signature_of(*find_model("EX9068AD-M"), "picb")), "9068ADM.picb");
}

TEST(Signature, DiffersForEachModelAndBoard) {
  std::set<std::string> signatures;
  for (const Model& model : kModels) {
    for (const char* board : {"pico", "pice", "picw", "picb"}) {
      signatures.insert(text_of(signature_of(model, board)));
    }
  }
  EXPECT_EQ(signatures.size(), 4 * std::size(kModels));
}

}  // namespace ex9000::update
