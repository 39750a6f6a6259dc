#include "sim/app/main/play_record.hpp"

#include <utility>

namespace ex9000::sim {

PlayRecord::PlayRecord(Writing writing, Print print)
    : writing_(std::move(writing)), print_(std::move(print)) {}

void PlayRecord::run_begins(const std::string& what) {
  if (writing_.capture && !capture_) {
    capture_file_.emplace(*writing_.capture, is_there(*writing_.capture));
    capture_ = std::make_unique<Capture>(*writing_.capture, "--capture: ");
    capture_->begin();
  }
  what_ = what;
  if (writing_.log == LogFormat::Text) {
    print_("plays   " + what);
  }
}

Faults::Notice PlayRecord::line_started(Line& line, const std::string& name) {
  const bool says_which = !name.empty() && writing_.log == LogFormat::Text;
  const Print printed =
      says_which ? [this, name](const std::string& text) { print_(name + ": " + text); } : print_;
  lines_.push_back(std::make_unique<LineRecord>(line, name.empty() ? what_ : what_ + " " + name,
                                                writing_.log.value_or(LogFormat::Text), printed));
  LineRecord& record = *lines_.back();
  if (writing_.log) {
    record.print_frames();
  }
  if (capture_) {
    record.keep_in(*capture_, VirtualTime(0));  // the capture must not depend on the time of day
    capture_file_->keep();
  }
  if (!writing_.log) {
    return nullptr;
  }
  return [&record](const std::string& text) { record.note(text); };
}

void PlayRecord::time_reached(VirtualTime now) {
  for (const auto& line : lines_) {
    if (FrameWatch* frames = line->frames()) {
      frames->run(now);
    }
  }
}

void PlayRecord::run_ends() {
  for (const auto& line : lines_) {
    line->finish();
  }
  lines_.clear();
}

}  // namespace ex9000::sim
