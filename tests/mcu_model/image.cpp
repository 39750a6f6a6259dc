#include "tests/mcu_model/image.hpp"

#include <dlfcn.h>

#include <stdexcept>

namespace ex9000::registers {

const Image& load_image(const std::string& path) {
  void* object = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* image = object == nullptr ? nullptr : dlsym(object, "ex9000_image");
  if (image == nullptr) {
    throw std::runtime_error(
        dlerror());  // NOLINT(concurrency-mt-unsafe): tests load images before they start threads
  }
  return *static_cast<const Image*>(image);
}

}  // namespace ex9000::registers
