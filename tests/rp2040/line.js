// A serial line of characters 8N1: a sender, and a receiver that samples each bit in its middle.
"use strict";

const BITS = 10; // a start bit, eight data bits, a stop bit

class Sender {
  // Calls `drive(level)` to set the level, and `ended()` when the stop bit is over.
  constructor(clock, drive, ended) {
    this.drive = drive;
    this.ended = ended;
    this.bitTime = 0;
    this.bits = 0;
    this.alarm = clock.createAlarm(() => this.nextBit());
    this.busy = false;
  }

  send(byte, bitTime) {
    this.busy = true;
    this.bitTime = bitTime;
    this.bits = (byte << 1) | 0x200;
    this.left = BITS;
    this.nextBit();
  }

  nextBit() {
    if (this.left === 0) {
      this.busy = false;
      this.ended();
      return;
    }
    this.drive((this.bits & 1) !== 0);
    this.bits >>= 1;
    this.left -= 1;
    this.alarm.schedule(this.bitTime);
  }
}

class Receiver {
  // Calls `receive({ byte, good, isBreak })` in the middle of the stop bit of each character. `good`: the stop bit is
  // high.
  constructor(clock, receive) {
    this.receive = receive;
    this.bitTime = 0; // 0: off
    this.high = true;
    this.sampled = -1; // number of bits of the present character that have been sampled; -1: no character has begun
    this.bits = 0;
    this.alarm = clock.createAlarm(() => this.sample());
  }

  level(high) {
    if (this.high && !high && this.sampled < 0 && this.bitTime > 0) {
      this.sampled = 0;
      this.bits = 0;
      this.alarm.schedule(this.bitTime / 2);
    }
    this.high = high;
  }

  sample() {
    if (this.sampled === 0 && this.high) {
      this.sampled = -1; // a glitch, not a start bit
      return;
    }
    if (this.high) {
      this.bits |= 1 << this.sampled;
    }
    this.sampled += 1;
    if (this.sampled < BITS) {
      this.alarm.schedule(this.bitTime);
      return;
    }
    this.sampled = -1;
    const byte = (this.bits >> 1) & 0xff;
    this.receive({ byte, good: this.high, isBreak: this.bits === 0 });
  }

  stop() {
    this.alarm.cancel();
    this.sampled = -1;
  }
}

module.exports = { BITS, Receiver, Sender };
