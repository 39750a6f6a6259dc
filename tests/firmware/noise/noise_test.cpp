// Tests a module on a line with noise and other faults, in Modbus RTU and in DCON with and without checksum.
// The module may reply or change outputs only if the bytes that it receives form a valid frame. The first
// test also counts the damaged frames that the module accepts, and compares this number with the theory.
//
//     EX9000_FRAMES=N    default 10,000. The first test sends N frames for each check and error rate. The
//                        second test sends N/20 requests for each check and fault. If the fault is a second
//                        master, this master sends N/20 additional requests.
//     EX9000_SEED=N      seed of the noise and of the requests; default 1
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/virtual_line/faults/echo.hpp"
#include "tests/firmware/noise/noisy_line.hpp"
#include "tests/firmware/noise/theory.hpp"
#include "tests/support/environment.hpp"

namespace ex9000::noise {
namespace {

using sim::VirtualTime;
using std::chrono::microseconds;
using std::chrono::milliseconds;

std::uint64_t frames() { return number_in_environment("EX9000_FRAMES", 10'000); }
std::uint64_t seed() { return number_in_environment("EX9000_SEED", 1); }

class Checks : public testing::TestWithParam<Check> {};

TEST_P(Checks, MissAsManyDamagedFramesAsTheTheoryExpects) {
  const double rates[] = {1e-5, 1e-4, 1e-3, 1e-2};
  for (const double rate : rates) {
    NoisyLine noisy(GetParam(), seed());
    Tally tally;
    while (tally.sent < frames()) {
      noisy.exchange(noisy.a_request(), rate, tally);
      if (HasFailure()) {
        return;
      }
      if (tally.sent % 500 == 0) {
        noisy.expect_the_first_clean_frame_is_answered();
      }
    }
    const Interval seen = interval_of(tally.taken_in_data);
    std::printf(
        "| %s | %.0e | %llu | %llu | %llu | %llu (%.3g to %.3g) | %.3g | %llu |\n", name_of(GetParam()), rate,
        static_cast<unsigned long long>(tally.sent), static_cast<unsigned long long>(tally.damaged),
        static_cast<unsigned long long>(tally.in_data), static_cast<unsigned long long>(tally.taken_in_data),
        seen.low, seen.high, tally.expected, static_cast<unsigned long long>(tally.taken_otherwise));
    std::fflush(stdout);
    // After a command that may store something, the test sets up the module again, because the theory does
    // not consider a module with another address. More such commands than the limit below are very unlikely.
    std::printf("  %llu exchanges with a command that may store something\n",
                static_cast<unsigned long long>(tally.storing));
    EXPECT_LE(tally.storing, 1 + tally.sent / 10'000);
    // A lower limit than this one would miss more errors; a higher one would reject too many seeds, because
    // there are twelve comparisons: four error rates for each of three checks. With 10,000 frames, the theory
    // expects no accepted frame from the CRC: the comparison then only finds a module that accepts one.
    EXPECT_GE(tail(tally.taken_in_data, tally.expected), 0.0005);
    EXPECT_GT(tally.damaged, 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Noise, Checks, testing::Values(Check::Crc, Check::Sum, Check::None));

/// A fault on the line, or several faults together, that the module must tolerate.
struct Trouble {
  const char* name;
  std::function<void(NoisyLine&, std::uint64_t exchanges)> happens;
};

void ask(NoisyLine& noisy) {
  const FrameBytes request = noisy.a_request();
  noisy.line().master().send(request.data(), request.size());
  noisy.line().wires().run_for(noisy.line().master().takes(request.size()) + milliseconds(4) +
                               microseconds(noisy.below(4000)));
}

void with_rates(NoisyLine& noisy, std::uint64_t exchanges, sim::NoiseRates rates) {
  noisy.noise().set_rates(rates);
  for (std::uint64_t i = 0; i < exchanges; ++i) {
    ask(noisy);
  }
  EXPECT_GT(noisy.noise().changes(), exchanges / 20);
}

sim::NoiseRates only(double sim::NoiseRates::*what, double rate) {
  sim::NoiseRates rates;
  rates.*what = rate;
  return rates;
}

void late_driver(NoisyLine& noisy, std::uint64_t exchanges) {
  noisy.noise().set_rates(only(&sim::NoiseRates::lost_in_contention, 0.5));
  for (std::uint64_t i = 0; i < exchanges; ++i) {
    noisy.line().module(0).release_driver_late(microseconds(noisy.below(5000)));
    ask(noisy);
  }
  noisy.line().module(0).release_driver_late(VirtualTime(0));
}

void echo(NoisyLine& noisy, std::uint64_t exchanges) {
  auto& repeater = noisy.attach<sim::Echo>(hal::SerialMode{NoisyLine::kBaud});
  repeater.switch_on(milliseconds(3));
  for (std::uint64_t i = 0; i < exchanges; ++i) {
    ask(noisy);
    noisy.line().wires().run_for(microseconds(noisy.below(6000)));
  }
  repeater.switch_off();
}

/// Adds another master, which sends the same kinds of requests at random times.
void another_master(NoisyLine& noisy, std::uint64_t exchanges, hal::SerialMode mode) {
  auto& other = noisy.attach<sim::Master>(mode, [](std::uint8_t, ByteStatus) {});
  for (std::uint64_t i = 0; i < exchanges; ++i) {
    const FrameBytes request = noisy.a_request();
    other.send(request.data(), request.size(),
               noisy.line().clock().virtual_now() + microseconds(noisy.below(6000)));
    ask(noisy);
  }
  while (other.sending()) {
    noisy.line().wires().run_for(milliseconds(10));
  }
}

const std::vector<Trouble>& troubles() {
  static const std::vector<Trouble> all{
      {"LostCharacters",
       [](NoisyLine& noisy, std::uint64_t exchanges) {
         with_rates(noisy, exchanges, only(&sim::NoiseRates::lost_character, 0.02));
       }},
      {"StrayCharacters",
       [](NoisyLine& noisy, std::uint64_t exchanges) {
         with_rates(noisy, exchanges, only(&sim::NoiseRates::stray_character, 0.02));
       }},
      {"StrayZeros",
       [](NoisyLine& noisy, std::uint64_t exchanges) {
         with_rates(noisy, exchanges, only(&sim::NoiseRates::stray_zero, 0.02));
       }},
      {"FlippedBitsAndLostAndStrayCharacters",
       [](NoisyLine& noisy, std::uint64_t exchanges) {
         with_rates(noisy, exchanges, {0.001, 0.01, 0.01, 0.01, 0});
       }},
      {"ADriverThatGoesOffLate", late_driver},
      {"AnEcho", echo},
      {"AMasterAtAQuarterOfTheRate",
       [](NoisyLine& noisy, std::uint64_t exchanges) { another_master(noisy, exchanges, {28800}); }},
      {"AMasterAtHalfTheRate",
       [](NoisyLine& noisy, std::uint64_t exchanges) { another_master(noisy, exchanges, {57600}); }},
      {"AMasterAtTwiceTheRate",
       [](NoisyLine& noisy, std::uint64_t exchanges) { another_master(noisy, exchanges, {230400}); }},
      {"TwoMasters", [](NoisyLine& noisy,
                        std::uint64_t exchanges) { another_master(noisy, exchanges, {NoisyLine::kBaud}); }},
      {"AMasterWithEvenParity",
       [](NoisyLine& noisy, std::uint64_t exchanges) {
         another_master(noisy, exchanges, {NoisyLine::kBaud, LineFormat::k8E1});
       }},
  };
  return all;
}

class ALineWith : public testing::TestWithParam<std::tuple<Trouble, Check>> {};

TEST_P(ALineWith, TheModuleActsOnlyOnValidFramesAndRepliesToTheFirstCleanFrame) {
  const auto& [trouble, check] = GetParam();
  const std::uint64_t exchanges = frames() / 20;
  NoisyLine noisy(check, seed());
  trouble.happens(noisy, exchanges);
  const std::uint64_t replies_and_output_changes = noisy.replies_and_output_changes();
  noisy.expect_the_first_clean_frame_is_answered();
  std::printf("%s, %s: %llu exchanges, %llu replies and changes of outputs\n", trouble.name, name_of(check),
              static_cast<unsigned long long>(exchanges),
              static_cast<unsigned long long>(replies_and_output_changes));
  EXPECT_GT(replies_and_output_changes, exchanges / 20);
}

INSTANTIATE_TEST_SUITE_P(Noise, ALineWith,
                         testing::Combine(testing::ValuesIn(troubles()),
                                          testing::Values(Check::Crc, Check::Sum, Check::None)),
                         [](const auto& one) {
                           return std::string(std::get<0>(one.param).name) +
                                  std::to_string(static_cast<int>(std::get<1>(one.param)));
                         });

}  // namespace
}  // namespace ex9000::noise
