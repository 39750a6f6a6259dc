#include "sim/app/running_line/line_record.hpp"

#include <utility>
#include <vector>

#include "sim/app/running_line/hints.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

StationNames stations_of(Line& line) {
  std::vector<std::string> names{"master"};
  for (std::size_t i = 0; i < line.size(); ++i) {
    SimulatedModule& module = line.module(i);
    names.push_back(hex_byte_text(module.module().state().in_force.address) + " " +
                    std::string(module.model().designation));
  }
  return StationNames(std::move(names));
}

}  // namespace

LineRecord::LineRecord(Line& line, std::string name, LogFormat format, const Print& print)
    : line_(line),
      name_(std::move(name)),
      log_(format == LogFormat::Json ? json_log(name_, stations_of(line), print)
                                     : text_log(stations_of(line), print)) {}

void LineRecord::note(const std::string& text) { write(text, true); }

void LineRecord::event(const std::string& text) { write(text, prints_); }

void LineRecord::write(const std::string& text, bool prints) {
  if (over_) {
    return;
  }
  const VirtualTime now = line_.clock().virtual_now();
  if (prints) {
    log_->note(now, text);
  }
  if (also_note_) {
    also_note_(now, text);
  }
}

void LineRecord::hear_modules() {
  const StationNames names = stations_of(line_);
  for (std::size_t i = 0; i < line_.size(); ++i) {
    line_.module(i).tell(
        [this, place = names.of(i + 1) + ": "](const std::string& text) { event(place + text); });
  }
}

void LineRecord::tell(FrameWatch::Take take, LineLog::Note note) {
  also_note_ = std::move(note);
  hear_modules();
  listen(std::move(take));
}

void LineRecord::print_frames() {
  prints_ = true;
  hear_modules();
  listen([this](const Frame& frame) {
    if (!over_) {
      log_->frame(frame);
    }
  });
}

void LineRecord::keep_in(Capture& capture, VirtualTime began) {
  const std::size_t line = capture.add_line(name_, line_.size(), began);
  listen([this, &capture, line](const Frame& frame) {
    if (!over_) {
      capture.write(line, frame);
    }
  });
}

void LineRecord::end_at(VirtualTime end) { line_.wires().attach(*this).run_at(end); }

void LineRecord::run() {
  frames_.finish();
  over_ = true;
}

void LineRecord::listen(FrameWatch::Take take) {
  takers_.push_back(std::move(take));
  if (!listens_) {
    frames_.add_receiver([this](const Frame& frame) { this->take(frame); });
    line_.wires().observe(frames_);
  }
  listens_ = true;
}

void LineRecord::take(const Frame& frame) {
  constexpr std::size_t kMostHints = 300;  // there are fewer texts; only addresses vary
  for (const FrameWatch::Take& taker : takers_) {
    taker(frame);
  }
  if (gives_hints_ && hints_.size() < kMostHints) {
    const std::string hint = hint_for(frame, line_);
    if (!hint.empty() && hints_.insert(hint).second) {
      note(hint);
    }
  }
}

}  // namespace ex9000::sim
