#include "sim/utility/console/progress.hpp"

#include <utility>

namespace ex9000::utility {

Progress::Progress(Environment& environment, std::string name)
    : environment_(environment), name_(std::move(name)) {}

Progress::~Progress() {
  if (shown_ && environment_.error_is_terminal) {
    environment_.error << std::endl;
  }
}

void Progress::clear() {
  if (shown_ && environment_.error_is_terminal) {
    environment_.error << "\r\033[K" << std::flush;
  }
}

void Progress::show(std::uint64_t done, std::uint64_t of) {
  constexpr std::size_t kWidth = 40;
  if (of == 0) {
    return;
  }
  constexpr unsigned kPercent = 100;
  const std::string percent = std::to_string(kPercent * done / of) + " %";
  if (environment_.error_is_terminal) {
    std::string bar(kWidth * done / of, '#');
    bar.resize(kWidth, ' ');
    environment_.error << "\r" << name_ << " [" << bar << "] " << percent << std::flush;
  } else if (const int tenth = static_cast<int>(10 * done / of); tenth != tenth_) {
    environment_.error << name_ << ": " << percent << std::endl;
    tenth_ = tenth;
  }
  shown_ = true;
}

}  // namespace ex9000::utility
