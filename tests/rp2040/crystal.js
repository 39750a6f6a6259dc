// The crystal oscillator, and a guard that rejects the crystal as the reference clock while the crystal is not stable.
// Source: RP2040 data sheet, 2.16 (crystal oscillator).
"use strict";
const { BasePeripheral } = require("rp2040js");

const ENABLE = 0xfab;
const RANGE = 0xaa0;
const STABLE = (1 << 31) >>> 0;
const DELAY_AFTER_RESET = 0xc4;
const DELAY_UNIT = 256; // periods of the crystal
const STARTS = 1e6; // ns from the enable until the crystal oscillates
const REFERENCE_CONTROL = 0x30;
const FROM_CRYSTAL = 2;

class Crystal extends BasePeripheral {
  constructor(rp2040, name) {
    super(rp2040, name);
    this.delay = DELAY_AFTER_RESET;
    this.stableAt = Infinity;
  }

  get stable() {
    return this.rp2040.clock.nanos >= this.stableAt;
  }

  readUint32(offset) {
    return offset === 4 ? (this.stable ? STABLE : 0) : super.readUint32(offset);
  }

  writeUint32(offset, value) {
    if (offset === 0x0c) {
      this.delay = value & 0x3fff;
    } else if (offset === 0 && value === ((ENABLE << 12) | RANGE)) {
      this.stableAt = this.rp2040.clock.nanos + STARTS + (this.delay * DELAY_UNIT * 1e9) / this.rp2040.xoscFreq;
    } else {
      this.error(`the value 0x${value.toString(16)} at offset 0x${offset.toString(16)} is not in this model; `
        + "expected 0xfabaa0 at offset 0x0");
    }
  }
}

// Makes `clocks` reject the crystal as the reference clock while the crystal is not stable.
function requireStable(clocks, crystal) {
  const write = clocks.writeUint32.bind(clocks);
  Object.assign(clocks, {
    writeUint32(offset, value) {
      if (offset === REFERENCE_CONTROL && (value & 3) === FROM_CRYSTAL && !crystal.stable) {
        crystal.error("it becomes the reference clock before it is stable");
      }
      write(offset, value);
    },
  });
}

module.exports = { Crystal, requireStable };
