#include "tests/mcu_model/line_bench.hpp"

namespace ex9000::registers {

LineBench::LineBench(Timeline& timeline, Net& transmit, Net& enable, Net& receive, bool echo)
    : timeline_(timeline),
      transmit_(transmit),
      enable_(enable),
      receive_(receive),
      echo_(echo),
      sender_(
          timeline,
          [this](bool high) {
            master_level_ = high;
            update();
          },
          [this] {
            sent_ = timeline_.now();
            go_on();
          }),
      ear_(timeline, [this](SerialReceiver::Received received) {
        const unsigned stop_bit = first_stop_bit(format_);
        const Instant started = timeline_.now() - bit_time_ / 2 - stop_bit * bit_time_;
        last_safe_ = started + (stop_bit + 1) * bit_time_;
        last_ended_ = started + character_time();
        heard.push_back(
            {started, last_ended_, received.byte, !received.framing_error && !received.parity_error});
      }) {
  // While the pins float, these resistors keep the transmit pin high and the driver off. A board has such a
  // resistor at the driver enable pin, but not at the transmit pin.
  transmit_.drive(End::Resistor, Drive::WeakHigh);
  enable_.drive(End::Resistor, Drive::WeakLow);
  transmit_.on_change([this] { board_speaks(); });
  enable_.on_change([this] { driver_switched(); });
  set_baud(9600);
  update();
}

void LineBench::set_baud(std::uint32_t baud) {
  bit_time_ = std::chrono::duration_cast<Instant>(std::chrono::seconds(1)) / baud;
  ear_.set_bit_time(bit_time_);
}

void LineBench::set_format(LineFormat format) {
  format_ = format;
  ear_.set_format(format);
}

void LineBench::send(const std::vector<std::uint8_t>& bytes) {
  for (const std::uint8_t byte : bytes) {
    waiting_.push_back({byte});
  }
  if (!sender_.busy()) {
    go_on();
  }
}

void LineBench::send_one(Character character) {
  waiting_.push_back(character);
  if (!sender_.busy()) {
    go_on();
  }
}

void LineBench::go_on() {
  if (waiting_.empty()) {
    master_level_ = true;  // the line is idle, even after a low stop bit
    update();
    return;
  }
  const Character next = waiting_.front();
  waiting_.pop_front();
  sender_.begin(next, format_, bit_time_, timeline_.now());
}

void LineBench::board_speaks() {
  if (!enable_.level() && !transmit_.level()) {
    ++bits_lost;
  }
  update();
}

void LineBench::driver_switched() {
  if (enable_.level()) {
    drives.push_back({timeline_.now(), kNever});
  } else {
    drives.back().to = timeline_.now();
    let_go_early += ear_.busy() || drives.back().to < last_safe_ - bit_time_ / 10 ? 1U : 0U;
    let_go_late += drives.back().to > last_ended_ + character_time() ? 1U : 0U;
  }
  update();
}

void LineBench::update() {
  const bool board_level = !enable_.level() || transmit_.level();
  ear_.level(board_level);
  const bool line = board_level && master_level_;
  receive_.drive(End::Board, enable_.level() && !echo_ ? Drive::High : line ? Drive::High : Drive::Low);
}

}  // namespace ex9000::registers
