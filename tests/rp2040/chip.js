// One RP2040, from its start to the next reset or power-off: rp2040js with the models in this folder. It starts
// at the first instruction of the second stage, in the state in which the boot ROM calls the second stage. Source:
// RP2040 data sheet, 2.8.1 (boot sequence).
"use strict";
const { RP2040, GPIOPinState } = require("rp2040js");
const { Processor } = require("./core");
const { Crystal, requireStable } = require("./crystal");
const { correctI2c } = require("./i2c");
const { Pl011 } = require("./pl011");
const { correctPll } = require("./pll");
const { QspiPins, Ssi } = require("./ssi");
const { ChipReset, Guarded, Resets, Watchdog } = require("./system");

const RAM = 0x20000000;
const SECOND_STAGE = 0x20041f00;
const SECOND_STAGE_SIZE = 256;
const RING_OSCILLATOR = 6.5e6;
const BOOT_ATTEMPT = 4e6; // ns between two attempts of the boot ROM, which the ring oscillator clocks
const BOOT_ATTEMPTS = 128;
const FORCE_OFF = 0x04;
const SECOND_CORE = 1 << 16;
const PAD_AFTER_RESET = 0x56;
const NO_FUNCTION = 0x1f;
const UART_FUNCTION = 2;
const I2C_FUNCTION = 3;
const BLOCK = { i2c0: 1 << 3, pins: 1 << 5, pads: 1 << 8, pllSys: 1 << 12, timer: 1 << 21, uart0: 1 << 22 };
const UART0_IRQ = 20;

function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte << 24;
    for (let bit = 0; bit < 8; bit += 1) {
      crc = crc & 0x80000000 ? (crc << 1) ^ 0x04c11db7 : crc << 1;
    }
  }
  return crc >>> 0;
}

const REJECT = {
  debug() {},
  info() {},
  warn(name, message) {
    throw new Error(`${name}: ${message}`);
  },
  error(name, message) {
    throw new Error(`${name}: ${message}`);
  },
};

class Chip {
  // `board` contains { clock, flash, pins, reason, chipReset, scratch, transmitted, transmit(level),
  // pinChanged(number), reset(reason) }.
  constructor(board) {
    this.board = board;
    this.mcu = new RP2040(board.clock);
    this.mcu.logger = REJECT;
    this.mcu.clkSys = RING_OSCILLATOR;
    this.mcu.roscFreq = RING_OSCILLATOR;
    this.processor = new Processor(this.mcu);
    this.replacePeripherals();
    this.fillRam();
    this.startPins();
    this.boot();
  }

  replacePeripherals() {
    const { board, mcu } = this;
    const { peripherals } = mcu;
    this.resets = new Resets(mcu, "RESETS", (blocks) => this.resetBlocks(blocks));
    this.psm = peripherals[0x40010];
    this.countSecondCoreResets();
    this.timer = peripherals[0x40054];
    this.watchdog = new Watchdog(mcu, "WATCHDOG", this.psm, board);
    this.uart = new Pl011(mcu, "UART0", UART0_IRQ, {
      transmit: (level) => board.transmit(level),
      mayTransmit: () => this.drives(board.pins.transmit, UART_FUNCTION),
      mayReceive: () => this.listens(board.pins.receive, UART_FUNCTION),
    });
    mcu.uart.forEach((uart) => Object.assign(uart, { clkPeriChanged: () => {} }));
    const qspi = new QspiPins(mcu, "IO_QSPI", board.flash);
    const guarded = (base, block) => {
      const inner = peripherals[base];
      const bit = BLOCK[block];
      peripherals[base] = new Guarded(inner, block, () => (this.resets.held & bit ? "it is held in reset" : ""));
    };
    peripherals[0x18000] = new Ssi(mcu, "SSI", board.flash, qspi);
    peripherals[0x40018] = qspi;
    peripherals[0x4000c] = this.resets;
    peripherals[0x40024] = new Crystal(mcu, "XOSC");
    requireStable(mcu.clocks, peripherals[0x40024]);
    correctPll(peripherals[0x40028], peripherals[0x40024], mcu.clocks);
    peripherals[0x40058] = this.watchdog;
    peripherals[0x40064] = new ChipReset(mcu, "CHIP_RESET", board.chipReset);
    peripherals[0x40034] = this.uart;
    this.i2c = mcu.i2c[0];
    correctI2c(this.i2c);
    guarded(0x40014, "pins");
    guarded(0x4001c, "pads");
    guarded(0x40028, "pllSys");
    guarded(0x40034, "uart0");
    guarded(0x40044, "i2c0");
    guarded(0x40054, "timer");
    peripherals[0x40054] = new Guarded(peripherals[0x40054], "timer", () => this.tickProblem());
  }

  // Returns what is wrong with the tick of the timer, or an empty text if nothing is wrong. The timer counts only while
  // the tick runs, and counts microseconds only if the tick matches the crystal.
  tickProblem() {
    const { tickFrequency } = this.watchdog;
    if (tickFrequency === 0) {
      return "the tick of the watchdog does not run";
    }
    return this.mcu.clocks.refCtrl === 2 && tickFrequency !== 1e6
      ? `the tick has ${tickFrequency} Hz; expected 1000000 Hz` : "";
  }

  get i2cBitTime() {
    const { i2c, mcu } = this;
    return ((i2c.sclLowPeriod + i2c.sclHighPeriod) / mcu.clkSys) * 1e9;
  }

  // Fills RAM with noise, because its content after power-on is undefined.
  fillRam() {
    let state = 0x2545f491;
    const { sram } = this.mcu;
    for (let index = 0; index < sram.length; index += 4) {
      state ^= state << 13;
      state ^= state >>> 17;
      state ^= state << 5;
      this.mcu.sramView.setInt32(index, state, true);
    }
  }

  startPins() {
    this.mcu.gpio.forEach((pin, number) => {
      Object.assign(pin, { padValue: PAD_AFTER_RESET, ctrl: NO_FUNCTION, lastValue: GPIOPinState.InputPullDown });
      pin.addListener(() => this.board.pinChanged(number));
    });
  }

  drives(number, wanted) {
    const pin = this.mcu.gpio[number];
    return pin.functionSelect === wanted && !pin.outputDisable;
  }

  listens(number, wanted) {
    const pin = this.mcu.gpio[number];
    return pin.functionSelect === wanted && pin.inputEnable;
  }

  get i2cConnected() {
    const { data } = this.board.pins;
    return this.listens(data, I2C_FUNCTION) && this.listens(data + 1, I2C_FUNCTION);
  }

  // Returns the level to which the chip drives a pin, or null if the chip does not drive it.
  level(number) {
    const pin = this.mcu.gpio[number];
    if (number === this.board.pins.transmit && this.drives(number, UART_FUNCTION)) {
      return this.board.transmitted;
    }
    if (pin.outputEnable && !pin.outputDisable) {
      return pin.outputValue;
    }
    return null;
  }

  pull(number) {
    const pin = this.mcu.gpio[number];
    if (pin.pullupEnabled === pin.pulldownEnabled) {
      return null;
    }
    return pin.pullupEnabled;
  }

  // Sets the system PLL, UART0, the timer, the pins and the pads to their states after a reset, if `blocks` contains
  // them. Other blocks keep their states.
  resetBlocks(blocks) {
    const { board, mcu } = this;
    if (blocks & BLOCK.pllSys) {
      mcu.pllSys.reset();
    }
    if (blocks & BLOCK.uart0) {
      this.uart.reset();
    }
    if (blocks & BLOCK.timer) {
      const { timer } = this;
      timer.alarms.forEach((alarm) => timer.disarmAlarm(alarm));
      Object.assign(timer, { intRaw: 0, intEnable: 0, intForce: 0 });
      timer.checkInterrupts();
    }
    if (blocks & (BLOCK.pins | BLOCK.pads)) {
      mcu.gpio.forEach((pin, number) => {
        Object.assign(pin, blocks & BLOCK.pins ? { ctrl: NO_FUNCTION, irqEnableMask: 0, irqForceMask: 0, irqStatus: 0 }
          : {}, blocks & BLOCK.pads ? { padValue: PAD_AFTER_RESET } : {});
        pin.checkForUpdates();
        board.pinChanged(number);
      });
      mcu.updateIOInterrupt();
    }
  }

  // Counts how often software releases the second core from reset.
  countSecondCoreResets() {
    const { psm } = this;
    const write = psm.writeUint32.bind(psm);
    this.secondCoreResets = 0;
    psm.writeUint32 = (offset, value) => {
      if (offset === FORCE_OFF && psm.frceOff & SECOND_CORE && !(value & SECOND_CORE)) {
        this.secondCoreResets += 1;
      }
      write(offset, value);
    };
  }

  // Resets only the processor. The boot ROM then starts again.
  resetProcessor() {
    this.mcu.ppb.reset();
    this.processor.reset();
    this.boot();
  }

  // Acts like the boot ROM, which reads the second stage again if the checksum is wrong, and gives up after some
  // attempts. While the flash is busy, the checksum cannot be correct, so this function tries again later. If the flash
  // is not busy, a wrong checksum is an error.
  boot(attempt = 1) {
    const { board, mcu } = this;
    mcu.core.waiting = board.flash.busy;
    if (board.flash.busy) {
      if (attempt === BOOT_ATTEMPTS) {
        throw new Error("boot ROM: the flash is busy at the last attempt; expected a flash that erases in less time");
      }
      board.clock.createAlarm(() => this.boot(attempt + 1)).schedule(BOOT_ATTEMPT);
      return;
    }
    const stage = board.flash.content.slice(0, SECOND_STAGE_SIZE);
    const end = SECOND_STAGE_SIZE - 4;
    if (crc32(stage.subarray(0, end)) !== new DataView(stage.buffer).getUint32(end, true)) {
      throw new Error("second stage: the checksum is wrong; expected the CRC-32 of the 252 bytes before it");
    }
    mcu.sram.set(stage, SECOND_STAGE - RAM);
    mcu.flash.fill(0); // the flash is not mapped
    mcu.core.PC = SECOND_STAGE;
    mcu.core.SP = SECOND_STAGE;
  }
}

module.exports = { Chip };
