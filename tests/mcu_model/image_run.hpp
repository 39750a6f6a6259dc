// Runs an image on a stack of its own. The image and the test never run at the same time.
#pragma once

#include <exception>

#include "tests/mcu_model/fiber.hpp"
#include "tests/mcu_model/image.hpp"
#include "tests/mcu_model/microcontroller.hpp"
#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

class ImageRun {
 public:
  /// Prepares a run from reset; the image does not start before `run_until`.
  ImageRun(const Image& image, Microcontroller& microcontroller, Timeline& timeline);
  ~ImageRun();
  ImageRun(const ImageRun&) = delete;
  ImageRun& operator=(const ImageRun&) = delete;

  /// Runs the image until `when`. Throws Fault or ResetRequest if the image causes one; the image does not
  /// run again after that, and later calls throw std::logic_error.
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
