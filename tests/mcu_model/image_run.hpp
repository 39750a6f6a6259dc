// An image at work. It has a stack of its own: whoever has the turn runs, the image or the test.
#pragma once

#include <exception>

#include "tests/mcu_model/fiber.hpp"
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

  const Image& image_;
  Microcontroller& microcontroller_;
  Timeline& timeline_;
  Instant limit_{0};
  bool begun_ = false;
  bool ending_ = false;
  bool over_ = false;
  std::exception_ptr failure_;
  Fiber fiber_;
};

}  // namespace ex9000::registers
