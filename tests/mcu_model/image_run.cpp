#include "tests/mcu_model/image_run.hpp"

#include <utility>

namespace ex9000::registers {

ImageRun::ImageRun(const Image& image, Microcontroller& microcontroller, Timeline& timeline)
    : image_(image), microcontroller_(microcontroller), timeline_(timeline) {
  microcontroller.on_exception(image.serve);
  microcontroller.pass_time_by([this](Instant to) { pass(to); });
  image.clear();
  thread_ = std::thread([this] { run(); });
}

ImageRun::~ImageRun() {
  ending_ = true;
  if (!over_) {
    hand_over(true);
  }
  thread_.join();
  microcontroller_.pass_time_by(nullptr);
}

void ImageRun::run_until(Instant when) {
  limit_ = when;
  if (!over_ && timeline_.now() < when) {
    hand_over(true);
  }
  if (failure_) {
    std::rethrow_exception(std::exchange(failure_, nullptr));
  }
}

void ImageRun::run() {
  {
    std::unique_lock<std::mutex> lock(mutex_);
    turned_.wait(lock, [this] { return images_turn_; });
  }
  if (!ending_) {
    try {
      image_.run();
    } catch (const Ended&) {
    } catch (...) {
      failure_ = std::current_exception();
    }
  }
  over_ = true;
  const std::lock_guard<std::mutex> lock(mutex_);
  images_turn_ = false;
  turned_.notify_all();
}

void ImageRun::pass(Instant to) {
  if (limit_ < to) {
    timeline_.advance(limit_);
    hand_over(false);
    if (ending_) {
      throw Ended();
    }
    return;  // whoever had the turn may have set alarms
  }
  timeline_.advance(to);
}

void ImageRun::hand_over(bool to_image) {
  std::unique_lock<std::mutex> lock(mutex_);
  images_turn_ = to_image;
  turned_.notify_all();
  turned_.wait(lock, [this, to_image] { return images_turn_ != to_image; });
}

}  // namespace ex9000::registers
