// Tests First and Second, the two data bytes of a reply. Sources: section 1.10 of the manuals; for models
// with more than eight inputs, wire.md section 1.
#include "firmware/dcon/writing.hpp"

#include <gtest/gtest.h>

#include <string>

namespace ex9000::dcon {
namespace {

std::string data_of(std::uint8_t inputs, std::uint8_t outputs) {
  const Model model{"EX9000D", inputs, outputs, 0, StatusStyle::TimeoutOnly, "9000", 6, "", OutputKind::None};
  Reply reply;
  put_data(model, 0x1234, 0x5678, reply);
  return {reply.bytes().begin(), reply.bytes().end()};
}

TEST(Data, IfThereAreMoreThanEightOutputsTheyUseBothBytesAndTheHighByteIsFirst) {
  EXPECT_EQ(data_of(0, 9), "1234");
  EXPECT_EQ(data_of(0, 16), "1234");
}

TEST(Data, IfThereAreMoreThanEightInputsTheyUseBothBytesAndTheHighByteIsFirst) {
  EXPECT_EQ(data_of(9, 0), "5678");
  EXPECT_EQ(data_of(16, 0), "5678");
}

TEST(Data, UpToEightOutputsPrecedeTheInputs) {
  EXPECT_EQ(data_of(8, 8), "3478");
  EXPECT_EQ(data_of(1, 1), "3478");
}

TEST(Data, UpToEightInputsComeFirstIfThereAreNoOutputs) { EXPECT_EQ(data_of(8, 0), "7800"); }

}  // namespace
}  // namespace ex9000::dcon
