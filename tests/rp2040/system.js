// Resets of blocks, the power-on state machine, the watchdog with its tick, and a guard that rejects the use of a block
// that silicon would not allow. Sources: RP2040 data sheet, 2.13, 2.14, 4.6.2 and 4.7; erratum RP2040-E1.
"use strict";
const { BasePeripheral } = require("rp2040js");

const ALL_BLOCKS = 0x1ffffff;
const IO_QSPI = 1 << 6;
const PADS_QSPI = 1 << 9;
const TIMER = 1 << 21;
const UARTS = 3 << 22;
// The blocks that are in reset after the boot ROM has released the others.
const AFTER_BOOT = ALL_BLOCKS & ~(IO_QSPI | PADS_QSPI | TIMER);

class Resets extends BasePeripheral {
  constructor(rp2040, name) {
    super(rp2040, name);
    this.held = AFTER_BOOT;
  }

  // Returns the blocks that have left their reset. A block whose clock does not run stays in reset.
  get done() {
    const stopped = this.rp2040.clocks.periFreq === 0 ? UARTS : 0;
    return ALL_BLOCKS & ~this.held & ~stopped;
  }

  readUint32(offset) {
    switch (offset) {
    case 0:
      return this.held;
    case 8:
      return this.done;
    default:
      return super.readUint32(offset);
    }
  }

  writeUint32(offset, value) {
    if (offset === 0) {
      this.held = value & ALL_BLOCKS;
    } else {
      super.writeUint32(offset, value);
    }
  }
}

// A block that rejects each access while it cannot be used. `problem()` returns the reason, or an empty text.
class Guarded {
  constructor(inner, name, problem) {
    this.inner = inner;
    this.name = name;
    this.problem = problem;
  }

  check() {
    const problem = this.problem();
    if (problem !== "") {
      throw new Error(`${this.name}: ${problem}`);
    }
  }

  readUint32(offset) {
    this.check();
    return this.inner.readUint32(offset);
  }

  writeUint32(offset, value) {
    this.check();
    this.inner.writeUint32(offset, value);
  }

  writeUint32Atomic(offset, value, kind) {
    this.check();
    this.inner.writeUint32Atomic(offset, value, kind);
  }
}

const ENABLE = 1 << 30;
const TRIGGER = 1 << 31;
const TICK_ENABLE = 1 << 9;
const TICK_RUNNING = 1 << 10;
const TICK_CYCLES = 0x1ff;
const COUNT = 0xffffff;
const COUNTS_A_TICK = 2; // RP2040-E1
const REASON = { powerOn: 0, timeout: 1, request: 2 };
const ALL_BUT_OSCILLATORS = 0x1fffc;

class Watchdog extends BasePeripheral {
  // `reset(reason)` resets the chip.
  constructor(rp2040, name, psm, reason, reset) {
    super(rp2040, name);
    this.psm = psm;
    this.reason = reason;
    this.reset = reset;
    this.enabled = false;
    this.tick = 0;
    this.load = 0;
    this.scratch = new Uint32Array(8);
    this.alarm = rp2040.clock.createAlarm(() => this.trigger(REASON.timeout));
  }

  get tickFrequency() {
    const cycles = this.tick & TICK_CYCLES;
    return this.tick & TICK_ENABLE && cycles > 0 ? this.rp2040.clocks.refFreq / cycles : 0;
  }

  readUint32(offset) {
    switch (offset) {
    case 0x00:
      return (this.enabled ? ENABLE : 0) >>> 0;
    case 0x08:
      return this.reason;
    case 0x2c:
      return this.tick | (this.tick & TICK_ENABLE ? TICK_RUNNING : 0);
    default:
      return offset >= 0x0c && offset <= 0x28 ? this.scratch[(offset - 0x0c) / 4] : super.readUint32(offset);
    }
  }

  writeUint32(offset, value) {
    switch (offset) {
    case 0x00:
      if (value & TRIGGER) {
        this.trigger(REASON.request);
      }
      this.enabled = (value & ENABLE) !== 0;
      this.run();
      break;
    case 0x04:
      this.load = value & COUNT;
      this.run();
      break;
    case 0x2c:
      this.tick = value & (TICK_CYCLES | TICK_ENABLE);
      this.run();
      break;
    default:
      super.writeUint32(offset, value);
    }
  }

  run() {
    const { tickFrequency } = this;
    if (!this.enabled || tickFrequency === 0) {
      this.alarm.cancel();
      return;
    }
    this.alarm.schedule((this.load / COUNTS_A_TICK / tickFrequency) * 1e9);
  }

  trigger(reason) {
    if ((this.psm.wdsel & ALL_BUT_OSCILLATORS) !== ALL_BUT_OSCILLATORS) {
      this.error("this reset leaves parts of the chip as they are");
    }
    this.reset(reason);
  }
}

module.exports = { Guarded, REASON, Resets, Watchdog };
