// Tests the turn-around time of images in each line format. The transcripts line-format-* test the rest.
#include <gtest/gtest.h>

#include <tuple>
#include <vector>

#include "firmware/model/baud.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/app/play/modbus_frame.hpp"
#include "sim/text/values.hpp"
#include "sim/virtual_line/wires/module.hpp"
#include "tests/boards/images_under_test.hpp"
#include "tests/mcu_model/board_bench.hpp"

namespace ex9000::registers {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

using ImageAndFormat = std::tuple<ImageName, LineFormat>;

class ImageInFormat : public testing::TestWithParam<ImageAndFormat> {
 protected:
  ImageInFormat() {
    const Model& model = *find_model(bench.image.model);
    Settings settings = Settings::factory(model);
    settings.baud_code = with_line_format(settings.baud_code, format());
    settings.protocol = protocol();
    bench.memory = sim::SimulatedModule::memory_image(model, settings);
    bench.line.set_format(format());
    bench.power_on();
    bench.run_for(milliseconds(100));
  }
  ~ImageInFormat() override {
    EXPECT_EQ(bench.line.let_go_early, 0U);
    EXPECT_EQ(bench.line.let_go_late, 0U);
    EXPECT_EQ(bench.resets, 0U);
  }

  [[nodiscard]] static LineFormat format() { return std::get<1>(GetParam()); }
  [[nodiscard]] Protocol protocol() const {
    return find_model(bench.image.model)->speaks_modbus() ? Protocol::ModbusRtu : Protocol::Ascii;
  }
  /// Sends a request to which every module replies, and returns the reply.
  std::vector<std::uint8_t> reply() {
    return bench.exchange(protocol() == Protocol::Ascii ? std::vector<std::uint8_t>{'$', '0', '1', 'M', '\r'}
                                                        : with_crc({1, 0x11}));
  }

  BoardBench bench{image_of(std::get<0>(GetParam()).board, std::get<0>(GetParam()).model)};
};

/// firmware/extensions.md, "Line format": in ASCII, the turn-around time is one character time of the line
/// format. In Modbus, it is T3.5 with characters of 11 bits.
TEST_P(ImageInFormat, RepliesImmediatelyAfterTheTurnAroundTimeOfTheFormat) {
  constexpr microseconds kAtOnce{100};
  const int character = format() == LineFormat::k8N1 ? 10 : 11;
  const Instant earliest =
      protocol() == Protocol::Ascii ? character * bench.line.bit_time() : 77 * bench.line.bit_time() / 2;
  for (int i = 0; i < 20; ++i) {
    bench.run_for(milliseconds(20) + microseconds(51 * i));
    bench.line.drives.clear();
    bench.line.heard.clear();
    ASSERT_FALSE(reply().empty());
    for (const LineBench::Heard& each : bench.line.heard) {
      EXPECT_TRUE(each.good);
    }
    ASSERT_EQ(bench.line.drives.size(), 1U);
    const Instant silence = bench.line.drives[0].from - bench.line.sent();
    EXPECT_GE(silence, earliest);
    EXPECT_LE(silence, earliest + kAtOnce);
  }
}

INSTANTIATE_TEST_SUITE_P(Images, ImageInFormat,
                         testing::Combine(testing::Values(ImageName{"lm3s6965evb", "EX9055D"},
                                                          ImageName{"lm3s6965evb", "EX9043D-M"},
                                                          ImageName{"ek-tm4c123gxl", "EX9055D"},
                                                          ImageName{"ek-tm4c123gxl", "EX9043D-M"}),
                                          testing::Values(LineFormat::k8N1, LineFormat::k8N2,
                                                          LineFormat::k8E1, LineFormat::k8O1)),
                         [](const auto& each) {
                           const ImageName& image = std::get<0>(each.param);
                           return name_of(testing::TestParamInfo<ImageName>(image, 0)) + "_" +
                                  sim::line_format_text(std::get<1>(each.param));
                         });

}  // namespace
}  // namespace ex9000::registers
