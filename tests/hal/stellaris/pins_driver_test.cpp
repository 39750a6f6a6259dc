// Tests outputs, inputs, INIT* and the LED on pins. Tests outputs and inputs in both polarities, because a
// board can use either polarity.
#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "hal/pins/single_pins.hpp"
#include "hal/stellaris/inputs.hpp"
#include "hal/stellaris/outputs.hpp"
#include "tests/mcu_model/driver_bench.hpp"

namespace ex9000::registers {
namespace {

using hal::stellaris::Gpio;
using hal::stellaris::PinGroup;
using hal::stellaris::Port;

// The channel numbers of the first group are below its pin numbers, and those of the second group are above
// its pin numbers. There is one more pin than channels.
constexpr std::array<PinGroup, 3> kGroups{PinGroup{Port::D, 2, 3}, PinGroup{Port::B, 0, 2},
                                          PinGroup{Port::D, 5, 2}};
constexpr unsigned kChannels = 6;
struct Place {
  char port;
  unsigned pin;
};
constexpr std::array<Place, kChannels> kPlaces{{{'D', 2}, {'D', 3}, {'D', 4}, {'B', 0}, {'B', 1}, {'D', 5}}};
constexpr Place kBeyond{'D', 6};  ///< in the last group, but without a channel

// --- outputs ---

template <bool is_active_high>
struct OutputKind {
  static constexpr bool kActiveHigh = is_active_high;
  using Pins = hal::stellaris::OutputPins<kGroups, kChannels, is_active_high>;
};

/// A resistor holds the pin of each channel at the inactive level while the microcontroller does not drive
/// this pin.
template <class Kind>
class Outputs : public testing::Test {
 protected:
  Outputs() {
    for (const Place place : kPlaces) {
      net(place).drive(End::Resistor, Kind::kActiveHigh ? Drive::WeakLow : Drive::WeakHigh);
    }
  }
  Net& net(Place place) { return bench.pins.at(place.port, place.pin); }
  /// Returns the energised channels: bit n is channel n.
  unsigned energised() {
    unsigned channels = 0;
    for (unsigned channel = 0; channel < kChannels; ++channel) {
      channels |= (net(kPlaces.at(channel)).level() == Kind::kActiveHigh ? 1U : 0U) << channel;
    }
    return channels;
  }

  unsigned changes = 0;  ///< counts changes of the nets; must outlive `bench`, which contains the nets
  DriverBench bench;
};
using OutputKinds = testing::Types<OutputKind<true>, OutputKind<false>>;
TYPED_TEST_SUITE(Outputs, OutputKinds);

TYPED_TEST(Outputs, StartDeenergisedAndWithoutAGlitch) {
  for (const Place place : kPlaces) {
    this->net(place).on_change([this] { ++this->changes; });
  }
  EXPECT_EQ(this->energised(), 0U);
  TypeParam::Pins::start();
  EXPECT_EQ(this->energised(), 0U);
  EXPECT_EQ(this->changes, 0U);
  for (const Place place : kPlaces) {
    const Drive inactive = TypeParam::kActiveHigh ? Drive::Low : Drive::High;
    EXPECT_EQ(this->net(place).driven_by(End::Microcontroller), inactive) << place.port << place.pin;
  }
}

TYPED_TEST(Outputs, EachChannelDrivesItsOwnPin) {
  TypeParam::Pins::start();
  for (unsigned channels = 0; channels < 1U << kChannels; ++channels) {
    TypeParam::Pins::drive(static_cast<std::uint16_t>(channels));
    ASSERT_EQ(this->energised(), channels);
  }
}

TYPED_TEST(Outputs, OtherPinsAreNotChanged) {
  // This pin is on the same port as two groups but does not belong to them.
  Gpio(Port::D).make_output(1U << 7U, 1U << 7U);
  TypeParam::Pins::start();
  for (const unsigned channels : {0x00U, 0x3FU, 0xFFFFU, 0x00U}) {
    TypeParam::Pins::drive(static_cast<std::uint16_t>(channels));
    EXPECT_EQ(this->net(kBeyond).driven_by(End::Microcontroller), Drive::Nothing);
    EXPECT_EQ(this->net({'D', 7}).driven_by(End::Microcontroller), Drive::High);
    EXPECT_EQ(this->net({'B', 2}).driven_by(End::Microcontroller), Drive::Nothing);
  }
}

// --- inputs ---

template <bool is_active_high>
struct InputKind {
  static constexpr bool kActiveHigh = is_active_high;
  using Pins = hal::stellaris::InputPins<kGroups, kChannels, is_active_high>;
};

template <class Kind>
class Inputs : public testing::Test {
 protected:
  static std::uint16_t start() {
    Kind::Pins::make_inputs();
    return Kind::Pins::start();
  }
  void wire(unsigned channel, bool level) {
    const Place place = kPlaces.at(channel);
    bench.pins.at(place.port, place.pin)
        .drive(End::Board, level == Kind::kActiveHigh ? Drive::High : Drive::Low);
  }

  using Edges = std::vector<std::pair<unsigned, bool>>;
  /// Returns the edges that the driver reports for both ports.
  Edges told() {
    Edges edges;
    const auto deliver = [&edges](unsigned channel, bool level) { edges.emplace_back(channel, level); };
    Kind::Pins::template take_edges<Port::B>(deliver);
    Kind::Pins::template take_edges<Port::D>(deliver);
    return edges;
  }

  DriverBench bench;
};
using InputKinds = testing::Types<InputKind<true>, InputKind<false>>;
TYPED_TEST_SUITE(Inputs, InputKinds);

TYPED_TEST(Inputs, AnOpenPinIsInactive) {
  EXPECT_EQ(this->start(), 0U);
  EXPECT_TRUE(this->told().empty());
}

TYPED_TEST(Inputs, StartReturnsThePresentLevels) {
  for (unsigned levels = 0; levels < 1U << kChannels; ++levels) {
    for (unsigned channel = 0; channel < kChannels; ++channel) {
      this->wire(channel, (levels >> channel & 1U) != 0);
    }
    ASSERT_EQ(this->start(), levels);
    EXPECT_TRUE(this->told().empty());
  }
}

TYPED_TEST(Inputs, APinWithoutAChannelIsNotInTheLevelsAtStart) {
  this->bench.pins.at(kBeyond.port, kBeyond.pin)
      .drive(End::Board, TypeParam::kActiveHigh ? Drive::High : Drive::Low);
  EXPECT_EQ(this->start(), 0U);
}

TYPED_TEST(Inputs, EachEdgeIsReportedOnceWithItsChannelAndLevel) {
  this->bench.mcu.core.hold(true);  // the test calls the driver, so interrupts must not call it
  this->start();
  for (unsigned channel = 0; channel < kChannels; ++channel) {
    for (const bool level : {true, false}) {
      this->wire(channel, level);
      const typename TestFixture::Edges expected{{channel, level}};
      EXPECT_EQ(this->told(), expected);
      EXPECT_TRUE(this->told().empty());
    }
  }
}

TYPED_TEST(Inputs, EachRisingOrFallingEdgeIsReportedOnceInAnInterrupt) {
  unsigned served = 0;
  const auto count = [&] { served += static_cast<unsigned>(this->told().size()); };
  this->bench.serve(1, count);  // port B
  this->bench.serve(3, count);  // port D
  this->start();
  unsigned edges = 0;
  for (unsigned channel = 0; channel < kChannels; ++channel) {
    for (const bool level : {true, false, true}) {
      this->wire(channel, level);
      this->bench.mcu.run_for(std::chrono::microseconds(10));
      EXPECT_EQ(served, ++edges) << channel;
    }
  }
  this->bench.mcu.run_for(std::chrono::milliseconds(1));
  EXPECT_EQ(served, edges);
}

TEST(InputPorts, AreOnlyThePortsOfTheChannels) {
  using AllOfThem = hal::stellaris::InputPins<kGroups, kChannels, true>;
  EXPECT_TRUE(AllOfThem::on(Port::B));
  EXPECT_TRUE(AllOfThem::on(Port::D));
  EXPECT_FALSE(AllOfThem::on(Port::A));
  EXPECT_FALSE(AllOfThem::on(Port::C));
  using OnlyTheFirst = hal::stellaris::InputPins<kGroups, 3, true>;
  EXPECT_FALSE(OnlyTheFirst::on(Port::B));
  EXPECT_TRUE(OnlyTheFirst::on(Port::D));
}

// --- switches ---

constexpr hal::stellaris::Pin kInit{Port::A, 7};
constexpr hal::stellaris::Pin kLed{Port::F, 0};

TEST(Switches, InitIsAssertedByALowPinAndReleasedByAnOpenPin) {
  DriverBench bench;
  using Init = hal::InitPin<kInit>;
  bench.pins.at('A', 6).drive(End::Board, Drive::High);
  Init::start();
  EXPECT_FALSE(Init::asserted());
  bench.pins.at('A', 7).drive(End::Board, Drive::Low);
  EXPECT_TRUE(Init::asserted());
  bench.pins.at('A', 7).drive(End::Board, Drive::Nothing);
  EXPECT_FALSE(Init::asserted());
}

TEST(Switches, TheLedIsOffAfterStartAndCanBeSwitchedOnAndOff) {
  DriverBench bench;
  using Led = hal::LedPin<kLed>;
  Led::start();
  const Net& net = bench.pins.at('F', 0);
  EXPECT_EQ(net.driven_by(End::Microcontroller), Drive::Low);
  Led::light(true);
  EXPECT_EQ(net.driven_by(End::Microcontroller), Drive::High);
  Led::light(false);
  EXPECT_EQ(net.driven_by(End::Microcontroller), Drive::Low);
}

}  // namespace
}  // namespace ex9000::registers
