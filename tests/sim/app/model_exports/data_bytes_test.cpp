// Tests the description of the data bytes of DCON replies.
#include "sim/app/model_exports/data_bytes.hpp"

#include <gtest/gtest.h>

namespace ex9000::sim {
namespace {

/// wire.md section 1: if a model has more than eight outputs, its data byte First contains DO8 and the higher
/// outputs. First is byte 0.
TEST(DataByte, ASingleChannelIsNotShownAsARange) {
  Model model = *find_model("EX9042D-M");
  model.outputs = 9;
  EXPECT_EQ(data_byte(model, 0), "DO8");
  EXPECT_EQ(data_byte(model, 1), "DO0-7");
}

}  // namespace
}  // namespace ex9000::sim
