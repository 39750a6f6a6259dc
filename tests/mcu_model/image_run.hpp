// An image at work. It runs in a thread of its own, never beside the test's: whoever has the turn runs.
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "tests/mcu_model/image.hpp"
#include "tests/mcu_model/microcontroller.hpp"
#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

class ImageRun {
 public:
  /// From reset on; nothing happens before `run_until`.
  ImageRun(const Image& image, Microcontroller& microcontroller, Timeline& timeline);
  ~ImageRun();
  ImageRun(const ImageRun&) = delete;
  ImageRun& operator=(const ImageRun&) = delete;

  /// Until it is that late. Throws what the image has brought about: Fault, ResetRequest.
  void run_until(Instant when);

 private:
  class Ended {};

  void run();
  void pass(Instant to);
  void hand_over(bool to_image);

  const Image& image_;
  Microcontroller& microcontroller_;
  Timeline& timeline_;
  Instant limit_{0};
  std::mutex mutex_;
  std::condition_variable turned_;
  bool images_turn_ = false;
  bool ending_ = false;
  bool over_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace ex9000::registers
