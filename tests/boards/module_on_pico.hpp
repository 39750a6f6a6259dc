// A module on a Pico in rp2040js, for image_masters_test.cpp.
#pragma once

#include <chrono>
#include <cstdint>

#include "firmware/model/baud.hpp"
#include "sim/app/play/transcript.hpp"
#include "tests/rp2040/pico_bench.hpp"

namespace ex9000 {

/// An EX9042D-M with address 01. The constructor returns when the module has started.
class EmulatedModule {
 public:
  EmulatedModule() {
    const Model& model = *find_model("EX9042D-M");
    Settings settings = Settings::factory(model);
    // The emulator is slow. The highest baud rate makes the test shorter, because a frame takes less time.
    settings.baud_code = kLastBaudCode;
    bench_.begin_anew(model, &settings);
    bench_.set_baud(baud_rate(settings.baud_code));
    bench_.power(true);
    // A module is ready to receive at the latest 100 ms after a reset (wire.md section 2).
    bench_.run_for(std::chrono::milliseconds(100));
  }
  play::Bytes reply_of(const play::Bytes& request) {
    constexpr std::chrono::milliseconds kSilence{5};
    constexpr std::chrono::milliseconds kLongestReply{250};
    constexpr std::size_t kLongestFrame = 256;
    bench_.run_for(kSilence);
    bench_.heard();
    bench_.send(request);
    play::Bytes reply = bench_.receive(1, kLongestReply);
    const play::Bytes rest = bench_.receive(kLongestFrame, kSilence);
    reply.insert(reply.end(), rest.begin(), rest.end());
    return reply;
  }
  std::uint16_t outputs() { return bench_.outputs(); }

 private:
  pico::PicoBench bench_;
};

}  // namespace ex9000
