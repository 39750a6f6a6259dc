// A PL011 UART with the duration of each bit, errors and overrun, without FIFOs. Sources: RP2040 data sheet, 4.2; Arm
// PrimeCell UART (PL011) TRM, 2.4 and 3.3.
"use strict";
const { BasePeripheral } = require("rp2040js");
const { FORMATS, Receiver, Sender, bitsOf } = require("./line");

const RECEIVED = 1 << 4;
const TRANSMITTED = 1 << 5;
const FRAMING_ERROR = 1 << 7;
const PARITY_ERROR = 1 << 8;
const BREAK_ERROR = 1 << 9;
const OVERRUN_ERROR = 1 << 10;

const DATA_FRAMING = 1 << 8;
const DATA_PARITY = 1 << 9;
const DATA_BREAK = 1 << 10;
const DATA_OVERRUN = 1 << 11;

const ENABLED = 1 << 0;
const TRANSMIT_ENABLED = 1 << 8;
const RECEIVE_ENABLED = 1 << 9;
// The formats that modules have, by the value of UARTLCR_H: WLEN with PEN, EPS and STP2. FEN is 0.
const LINE_CONTROL = { 0x60: FORMATS["8N1"], 0x62: FORMATS["8O1"], 0x66: FORMATS["8E1"], 0x68: FORMATS["8N2"] };

class Pl011 extends BasePeripheral {
  // `wires` contains { transmit(level), mayReceive(), mayTransmit() }. `transmit` sets the level of the transmit pin.
  // `mayReceive` and `mayTransmit` return whether the receive pin and the transmit pin are connected to the UART.
  constructor(rp2040, name, irq, wires) {
    super(rp2040, name);
    this.irq = irq;
    this.wires = wires;
    this.sender = new Sender(rp2040.clock, (level) => wires.transmit(level), () => this.sent());
    this.receiver = new Receiver(rp2040.clock, (character) => this.receive(character));
    this.reset();
  }

  // Sets the registers to their values after a reset of the block.
  reset() {
    this.integerDivisor = 0;
    this.fractionalDivisor = 0;
    this.bitTime = 0;
    this.latched = false;
    this.lineControl = 0;
    this.control = TRANSMIT_ENABLED | RECEIVE_ENABLED;
    this.mask = 0;
    this.raw = 0;
    this.received = [];
    this.overrun = false;
    this.toSend = [];
    this.listen();
    this.tell();
  }

  readUint32(offset) {
    switch (offset) {
    case 0x00:
      return this.takeReceived();
    case 0x04:
      return 0;
    case 0x18:
      return (this.sender.busy || this.toSend.length ? 1 << 3 : 0)
        | (this.received.length === 0 ? 1 << 4 : 0)
        | (this.toSend.length !== 0 ? 1 << 5 : 0)
        | (this.received.length !== 0 ? 1 << 6 : 0)
        | (this.toSend.length === 0 ? 1 << 7 : 0);
    case 0x24:
      return this.integerDivisor;
    case 0x28:
      return this.fractionalDivisor;
    case 0x2c:
      return this.lineControl;
    case 0x30:
      return this.control;
    case 0x38:
      return this.mask;
    case 0x3c:
      return this.raw;
    case 0x40:
      return this.raw & this.mask;
    default:
      return super.readUint32(offset);
    }
  }

  writeUint32(offset, value) {
    switch (offset) {
    case 0x00:
      this.transmit(value & 0xff);
      break;
    case 0x24:
      this.setUp("the divisor");
      this.integerDivisor = value & 0xffff;
      this.latched = false;
      break;
    case 0x28:
      this.setUp("the divisor");
      this.fractionalDivisor = value & 0x3f;
      this.latched = false;
      break;
    case 0x2c:
      this.setUp("the line control");
      if (!Object.hasOwn(LINE_CONTROL, value)) {
        this.error(`line control 0x${value.toString(16)} is not in this model; expected 8N1, 8N2, 8E1 or 8O1; no FIFO`);
      }
      this.lineControl = value;
      this.latch();
      break;
    case 0x30:
      if (this.sender.busy) {
        this.error("the control register changes while a character is sent");
      }
      if (value & ENABLED && !this.latched) {
        this.error("divisors have no effect until the line control register is written");
      }
      this.control = value;
      this.listen();
      break;
    case 0x38:
      this.mask = value;
      this.tell();
      break;
    case 0x44:
      this.raw &= ~value;
      this.tell();
      break;
    default:
      super.writeUint32(offset, value);
    }
  }

  setUp(what) {
    if (this.control & ENABLED) {
      this.error(`${what} is written while the UART is enabled`);
    }
  }

  latch() {
    const { clkPeri, clocks } = this.rp2040;
    if (clocks.periFreq === 0) {
      this.error("the peripheral clock does not run");
    }
    this.latched = true;
    this.bitTime = ((this.integerDivisor * 64 + this.fractionalDivisor) / 4 / clkPeri) * 1e9;
    if (this.integerDivisor === 0) {
      this.error("the divisor is 0");
    }
    this.listen();
  }

  listen() {
    const on = (this.control & (ENABLED | RECEIVE_ENABLED)) === (ENABLED | RECEIVE_ENABLED);
    this.receiver.bitTime = on ? this.bitTime : 0;
    this.receiver.format = this.format;
  }

  get format() {
    return LINE_CONTROL[this.lineControl] ?? FORMATS["8N1"];
  }

  get characterTime() {
    return bitsOf(this.format) * this.bitTime;
  }

  get baud() {
    return this.control & ENABLED ? Math.round(1e9 / this.bitTime) : 0;
  }

  // --- sending ---

  transmit(byte) {
    if ((this.control & (ENABLED | TRANSMIT_ENABLED)) !== (ENABLED | TRANSMIT_ENABLED)) {
      this.error("a byte is sent while the transmitter is off");
    }
    if (!this.wires.mayTransmit()) {
      this.error("a byte is sent while the pin is not connected to the UART");
    }
    if (this.toSend.length !== 0) {
      this.error("a byte is sent while there is no room for it");
    }
    if (this.sender.busy) {
      this.toSend.push(byte);
      this.raw &= ~TRANSMITTED;
      this.tell();
    } else {
      this.sender.send(byte, this.bitTime, this.format);
      this.raise(TRANSMITTED); // the byte has left the holding register
    }
  }

  sent() {
    if (this.toSend.length === 0) {
      return;
    }
    this.sender.send(this.toSend.shift(), this.bitTime, this.format);
    this.raise(TRANSMITTED);
  }

  // --- receiving ---

  level(high) {
    this.receiver.level(this.wires.mayReceive() ? high : true);
  }

  receive({ byte, good, rightParity, isBreak }) {
    if (this.received.length !== 0) {
      this.overrun = true;
      this.raise(OVERRUN_ERROR);
      return;
    }
    this.received.push(byte | (good ? 0 : DATA_FRAMING) | (rightParity ? 0 : DATA_PARITY) | (isBreak ? DATA_BREAK : 0)
      | (this.overrun ? DATA_OVERRUN : 0));
    this.overrun = false;
    if (!good) {
      this.raise(isBreak ? BREAK_ERROR : FRAMING_ERROR);
    }
    if (!rightParity) {
      this.raise(PARITY_ERROR);
    }
    this.raise(RECEIVED);
  }

  takeReceived() {
    if (this.received.length === 0) {
      this.error("the data register is read while nothing has been received");
    }
    const data = this.received.shift();
    this.raw &= ~RECEIVED;
    this.tell();
    return data;
  }

  raise(what) {
    this.raw |= what;
    this.tell();
  }

  tell() {
    this.rp2040.setInterrupt(this.irq, (this.raw & this.mask) !== 0);
  }
}

module.exports = { Pl011 };
