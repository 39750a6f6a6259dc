// The synchronous serial interface (SSI) of the flash, and the chip select pin of the flash. Source: RP2040 data sheet,
// 4.10 and 2.19.6.2. The model has only two transfer modes: both directions, and "EEPROM read".
"use strict";
const { BasePeripheral } = require("rp2040js");

const DEPTH = 16;
const BOTH_WAYS = 0;
const EEPROM_READ = 3;
const READ_DATA = 0x03;
const READ_DATA_LIMIT = 50e6; // Hz; source: W25Q16JV data sheet, 9.6 (AC electrical characteristics)

// The chip select pin of the flash. Either the SSI controls it, or software drives it low or high.
class QspiPins extends BasePeripheral {
  constructor(rp2040, name, chip) {
    super(rp2040, name);
    this.chip = chip;
    this.override = 0;
    this.wanted = false;
  }

  readUint32(offset) {
    return offset === 0x0c ? this.override << 8 : super.readUint32(offset);
  }

  writeUint32(offset, value) {
    if (offset !== 0x0c || (value & ~0x300) !== 0) {
      super.writeUint32(offset, value);
      return;
    }
    this.override = (value >> 8) & 3;
    this.update();
  }

  requestSelect(on) {
    this.wanted = on;
    this.update();
  }

  update() {
    const selected = this.override === 0 ? this.wanted : this.override === 2;
    if (selected !== this.chip.selected) {
      this.chip.select(selected);
    }
  }
}

class Ssi extends BasePeripheral {
  constructor(rp2040, name, chip, pins) {
    super(rp2040, name);
    this.chip = chip;
    this.pins = pins;
    this.control = 0;
    this.count = 0;
    this.enabled = false;
    this.slave = 0;
    this.divider = 0;
    this.toSend = [];
    this.received = [];
    this.left = 0; // number of frames that an EEPROM read still has to receive
    this.shifting = false;
    this.alarm = rp2040.clock.createAlarm(() => this.frameEnds());
  }

  get frameBits() {
    return ((this.control >> 16) & 0x1f) + 1;
  }

  get mode() {
    return (this.control >> 8) & 3;
  }

  readUint32(offset) {
    switch (offset) {
    case 0x00:
      return this.control;
    case 0x04:
      return this.count;
    case 0x08:
      return Number(this.enabled);
    case 0x20:
      return this.toSend.length;
    case 0x24:
      return this.received.length;
    case 0x28:
      return Number(this.shifting || this.left > 0)
        | (this.toSend.length < DEPTH ? 1 << 1 : 0)
        | (this.toSend.length === 0 ? 1 << 2 : 0)
        | (this.received.length > 0 ? 1 << 3 : 0)
        | (this.received.length === DEPTH ? 1 << 4 : 0);
    case 0x60:
      if (this.received.length === 0) {
        this.error("the data register is read while it is empty");
      }
      return this.received.shift();
    default:
      return super.readUint32(offset);
    }
  }

  writeUint32(offset, value) {
    if (this.enabled && [0x00, 0x04, 0x14].includes(offset)) {
      this.error(`register 0x${offset.toString(16)} is written while the SSI is enabled`);
    }
    switch (offset) {
    case 0x00:
      this.control = value;
      break;
    case 0x04:
      this.count = value & 0xffff;
      break;
    case 0x08:
      this.enable((value & 1) !== 0);
      break;
    case 0x10:
      this.slave = value;
      break;
    case 0x14:
      if (value < 2 || value % 2 !== 0) {
        this.error(`the divider is ${value}; expected an even number of at least 2`);
      }
      this.divider = value;
      break;
    case 0x60:
      this.send(value);
      break;
    default:
      super.writeUint32(offset, value);
    }
  }

  enable(on) {
    this.enabled = on;
    if (!on) {
      this.alarm.cancel();
      this.toSend = [];
      this.received = [];
      this.left = 0;
      this.shifting = false;
      this.pins.requestSelect(false);
    } else if (![BOTH_WAYS, EEPROM_READ].includes(this.mode) || ![8, 32].includes(this.frameBits)
      || (this.control & ~0x1f0300) !== 0) {
      this.error(`control 0x${this.control.toString(16)} is not in this model; expected frames of `
        + "8 or 32 bits, and the transfer mode 'both directions' or 'EEPROM read'");
    }
  }

  send(value) {
    if (!this.enabled || this.slave !== 1 || this.divider === 0) {
      this.error("a frame is sent before the SSI is set up");
    }
    if (this.toSend.length === DEPTH) {
      this.error("a frame is sent while there is no room for it");
    }
    this.toSend.push(value);
    if (!this.shifting) {
      const command = (value >>> (this.frameBits - 8)) & 0xff;
      const clock = this.rp2040.clkSys / this.divider;
      const isFirst = this.frameBits === 32 || this.chip.bytes.length === 0;
      if (command === READ_DATA && isFirst && clock > READ_DATA_LIMIT) {
        this.error(`Read Data has a clock of ${clock / 1e6} MHz; expected at most ${READ_DATA_LIMIT / 1e6} MHz`);
      }
      this.pins.requestSelect(true);
      this.beginFrame();
    }
  }

  beginFrame() {
    this.shifting = true;
    this.alarm.schedule((this.frameBits * this.divider * 1e9) / this.rp2040.clkSys);
  }

  frameEnds() {
    if (this.left > 0) {
      this.push(this.exchange(0));
      this.left -= 1;
    } else {
      const received = this.exchange(this.toSend.shift());
      if (this.mode === BOTH_WAYS) {
        this.push(received);
      } else if (this.toSend.length === 0) {
        this.left = this.count + 1;
      }
    }
    if (this.left > 0 || this.toSend.length > 0) {
      this.beginFrame();
    } else {
      this.shifting = false;
      this.pins.requestSelect(false);
    }
  }

  // Exchanges a frame with the flash, most significant byte first. Returns the received frame.
  exchange(frame) {
    let result = 0;
    for (let shift = this.frameBits - 8; shift >= 0; shift -= 8) {
      result = ((result << 8) | this.chip.exchange((frame >>> shift) & 0xff)) >>> 0;
    }
    return result;
  }

  push(frame) {
    if (this.received.length === DEPTH) {
      this.error("a frame is received while there is no room for it");
    }
    this.received.push(frame);
  }
}

module.exports = { QspiPins, Ssi };
