// A serial line: a sender of characters, and a receiver that samples each bit in its middle.
"use strict";

// A character has a start bit, eight data bits, a parity bit in some formats, and one or two stop bits. `parity` is the
// level of the parity bit of the byte 00, or null if the format has no parity bit.
const FORMATS = {
  "8N1": { parity: null, stopBits: 1 },
  "8N2": { parity: null, stopBits: 2 },
  "8E1": { parity: 0, stopBits: 1 },
  "8O1": { parity: 1, stopBits: 1 },
};

// Returns the position of the first stop bit, which is the last bit that a receiver reads. The start bit is at 0.
const firstStopBit = (format) => (format.parity === null ? 9 : 10);
// Returns the duration of a character in bits.
const bitsOf = (format) => firstStopBit(format) + format.stopBits;

function parityOf(byte, format) {
  let level = format.parity;
  for (let rest = byte; rest !== 0; rest >>= 1) {
    level ^= rest & 1;
  }
  return level;
}

// Returns the levels of a character. Bit 0 is the start bit.
function levelsOf(byte, format) {
  const stopBits = ((1 << format.stopBits) - 1) << firstStopBit(format);
  return (byte << 1) | stopBits | (format.parity === null ? 0 : parityOf(byte, format) << 9);
}

class Sender {
  // Calls `drive(level)` to set the level of the line, and `ended()` when the last stop bit has ended.
  constructor(clock, drive, ended) {
    this.drive = drive;
    this.ended = ended;
    this.bitTime = 0;
    this.bits = 0;
    this.alarm = clock.createAlarm(() => this.nextBit());
    this.busy = false;
  }

  send(byte, bitTime, format = FORMATS["8N1"]) {
    this.busy = true;
    this.bitTime = bitTime;
    this.bits = levelsOf(byte, format);
    this.left = bitsOf(format);
    this.atStartBit = true;
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
    this.atStartBit = false;
    this.alarm.schedule(this.bitTime);
  }
}

class Receiver {
  // Calls `receive({ byte, good, rightParity, isBreak })` in the middle of the first stop bit of each character.
  // `good` is true if this stop bit is high. `rightParity` is true if the parity bit is correct, or if the format has
  // no parity bit. `isBreak` is true if all bits from the start bit to this stop bit are low.
  constructor(clock, receive) {
    this.receive = receive;
    this.bitTime = 0; // 0: off
    this.format = FORMATS["8N1"];
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
    if (this.sampled <= firstStopBit(this.format)) {
      this.alarm.schedule(this.bitTime);
      return;
    }
    this.sampled = -1;
    const byte = (this.bits >> 1) & 0xff;
    const rightParity = this.format.parity === null || ((this.bits >> 9) & 1) === parityOf(byte, this.format);
    this.receive({ byte, good: this.high, rightParity, isBreak: this.bits === 0 });
  }

  stop() {
    this.alarm.cancel();
    this.sampled = -1;
  }
}

module.exports = { FORMATS, Receiver, Sender, bitsOf };
