// Resets of blocks, the source of the last chip-level reset, the watchdog with its tick, and a guard that rejects each
// access to a block that cannot be used. Sources: RP2040 data sheet, 2.12.7, 2.13, 2.14, 4.6.2 and 4.7; erratum
// RP2040-E1.
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
  // `reset(blocks)` sets these blocks to their state after a reset.
  constructor(rp2040, name, reset) {
    super(rp2040, name);
    this.held = AFTER_BOOT;
    this.reset = reset;
  }

  // Returns the blocks that have left their reset. The UARTs stay in reset while the peripheral clock does not
  // run.
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
      const before = this.held;
      this.held = value & ALL_BLOCKS;
      this.reset(this.held & ~before);
    } else {
      super.writeUint32(offset, value);
    }
  }
}

// A block that rejects each access while it cannot be used. `problem()` returns the reason why the block cannot be
// used, or an empty text if it can be used.
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

// The sources of a chip-level reset. A reset by the watchdog is not a chip-level reset.
const CHIP_RESET = { supply: 1 << 8, run: 1 << 16, debugPort: 1 << 20 };

class ChipReset extends BasePeripheral {
  constructor(rp2040, name, source) {
    super(rp2040, name);
    this.source = source;
  }

  readUint32(offset) {
    return offset === 8 ? this.source : super.readUint32(offset);
  }
}

const ENABLE = 1 << 30;
const TRIGGER = 1 << 31;
const TICK_ENABLE = 1 << 9;
const TICK_RUNNING = 1 << 10;
const TICK_CYCLES = 0x1ff;
const COUNT = 0xffffff;
const COUNTS_A_TICK = 2; // RP2040-E1
const REASON = { none: 0, timeout: 1, request: 2 };
const ALL_BUT_OSCILLATORS = 0x1fffc;
const SCRATCH_REGISTERS = 8;
const FIRST_SCRATCH = 0x0c;
const isScratch = (offset) => offset >= FIRST_SCRATCH && offset < FIRST_SCRATCH + 4 * SCRATCH_REGISTERS;

class Watchdog extends BasePeripheral {
  // `scratch` contains the scratch registers, which keep their values during a reset by the watchdog. `reset(reason)`
  // resets the chip.
  constructor(rp2040, name, psm, { reason, scratch, reset }) {
    super(rp2040, name);
    this.psm = psm;
    this.reason = reason;
    this.reset = reset;
    this.enabled = false;
    this.tick = 0;
    this.load = 0;
    this.scratch = scratch;
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
      return isScratch(offset) ? this.scratch[(offset - FIRST_SCRATCH) / 4] : super.readUint32(offset);
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
      if (isScratch(offset)) {
        this.scratch[(offset - FIRST_SCRATCH) / 4] = value;
      } else {
        super.writeUint32(offset, value);
      }
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
      const wdsel = this.psm.wdsel.toString(16);
      const all = ALL_BUT_OSCILLATORS.toString(16);
      this.error(`WDSEL is 0x${wdsel}, so this reset omits parts of the chip; expected all bits of 0x${all}`);
    }
    this.reset(reason);
  }
}

module.exports = { CHIP_RESET, ChipReset, Guarded, REASON, Resets, SCRATCH_REGISTERS, Watchdog };
