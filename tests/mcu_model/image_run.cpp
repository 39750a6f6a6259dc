#include "tests/mcu_model/image_run.hpp"

#include <stdexcept>
#include <utility>

namespace ex9000::registers {

ImageRun::ImageRun(const Image& image, Microcontroller& microcontroller, Timeline& timeline)
    : image_(image), microcontroller_(microcontroller), timeline_(timeline), fiber_([this] { run(); }) {
  microcontroller.on_exception(image.serve);
  microcontroller.pass_time_by([this](Instant to) { pass(to); });
  image.clear();
}

/// If the image has begun and has not ended, ends it with an exception, so that its stack is unwound and its
/// resources are released.
ImageRun::~ImageRun() {
  ending_ = true;
  if (begun_ && !over_) {
    fiber_.resume();
  }
  microcontroller_.pass_time_by(nullptr);
}

void ImageRun::run_until(Instant when) {
  if (over_) {
    throw std::logic_error("the image has ended and cannot run again");
  }
  limit_ = when;
  if (timeline_.now() < when) {
    begun_ = true;
    fiber_.resume();
  }
  if (failure_) {
    std::rethrow_exception(std::exchange(failure_, nullptr));
  }
}

void ImageRun::run() {
  try {
    image_.run();
  } catch (const Ended&) {
  } catch (...) {
    failure_ = std::current_exception();
  }
  over_ = true;
}

void ImageRun::pass(Instant to) {
  if (limit_ < to) {
    timeline_.advance(limit_);
    fiber_.suspend();
    if (ending_) {
      throw Ended();
    }
    return;  // possibly before `to`: the test may have set an alarm that is due earlier
  }
  timeline_.advance(to);
}

}  // namespace ex9000::registers
