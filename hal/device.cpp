#include "hal/device.hpp"

namespace ex9000::hal {

void Device::start(Duration tick, TimingAt timing_at) {
  module_.begin(board_.inputs.levels(), board_.clock.now(), timing_at);
  board_.tick.start(tick);
  board_.watchdog.feed();
}

void Device::on_receive(std::uint8_t byte, ByteStatus status) {
  if (board_.line.sending()) {
    return;
  }
  const Duration silence = module_.on_byte(byte, status, board_.clock.now());
  if (!(silence == Duration())) {
    board_.silence_timer.restart(silence);
  }
}

void Device::on_silence() {
  const Duration more = module_.on_silence(board_.clock.now());
  if (!(more == Duration())) {
    board_.silence_timer.restart(more);
  }
}

void Device::turn() {
  const Time now = board_.clock.now();
  look_after_memory();
  module_.step(board_.init_switch.asserted(), now);
  board_.outputs.drive(module_.outputs());
  board_.status_led.light(module_.led_lit());
  look_after_line(now);
  look_after_memory();
  if (module_.feed_watchdog()) {
    board_.watchdog.feed();
  }
}

void Device::look_after_line(Time now) {
  if (!line_open_) {
    if (!module_.listening()) {
      return;
    }
    line_open_ = true;
    board_.line.open(module_.baud());
  }
  if (reply_under_way_) {
    if (board_.line.sending()) {
      return;
    }
    reply_under_way_ = false;
    module_.reply_sent(now);
  }
  const Bytes reply = module_.take_reply(now);
  if (reply.size != 0) {
    reply_under_way_ = true;
    board_.line.send(reply);
    module_.reply_started();
  }
}

void Device::look_after_memory() {
  if (board_.memory.busy()) {
    return;
  }
  if (memory_job_under_way_) {
    memory_job_under_way_ = false;
    module_.memory_done(board_.memory.succeeded());
  }
  const MemoryJob job = module_.memory_job();
  switch (job.kind) {
    case MemoryJob::Kind::Read:
      board_.memory.start_read(job.address, job.destination);
      break;
    case MemoryJob::Kind::Write:
      board_.memory.start_write(job.address, job.source);
      break;
    case MemoryJob::Kind::None:
      return;
  }
  memory_job_under_way_ = true;
}

}  // namespace ex9000::hal
