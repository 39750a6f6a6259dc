// Tests what the models report, how long their operations take, and which accesses they reject. A model
// rejects an access that is an error on a real chip, that shows an error of the firmware, or that the model does not
// support.
"use strict";
const assert = require("node:assert/strict");
const { test } = require("node:test");
const { RP2040 } = require("rp2040js");
const { ChipClock, Time } = require("./clock");
const { Processor } = require("./core");
const { Crystal, requireStable } = require("./crystal");
const { Eeprom } = require("./eeprom");
const { FLASH_SIZE, FlashChip } = require("./flash_chip");
const { correctI2c } = require("./i2c");
const { FORMATS, Receiver, Sender, bitsOf } = require("./line");
const { Pl011 } = require("./pl011");
const { correctPll } = require("./pll");
const { QspiPins, Ssi } = require("./ssi");
const { CHIP_RESET, ChipReset, Guarded, Resets, Watchdog } = require("./system");

const BIT = 8680; // ns at 115200 baud
const PERI_ENABLE = 1 << 11;

function reject(name, message) {
  throw new Error(`${name}: ${message}`);
}

function setUp() {
  const time = new Time();
  const mcu = new RP2040(new ChipClock(time));
  mcu.logger = { debug() {}, info() {}, warn: reject, error: reject };
  mcu.uart.forEach((uart) => Object.assign(uart, { clkPeriChanged: () => {} }));
  return { time, mcu };
}

function uartOf({ mcu }, isOn = true) {
  const levels = [];
  const uart = new Pl011(mcu, "UART0", 20, {
    transmit: (level) => levels.push(level),
    mayTransmit: () => true,
    mayReceive: () => true,
  });
  mcu.clocks.periCtrl = PERI_ENABLE;
  mcu.clocks.sysCtrl = 1;
  mcu.clkPeri = 125e6;
  Object.defineProperty(mcu.clocks, "periFreq", { value: 125e6 });
  if (isOn) {
    uart.writeUint32(0x24, 67);
    uart.writeUint32(0x28, 52);
    uart.writeUint32(0x2c, 0x60);
    uart.writeUint32(0x30, 0x301);
  }
  return { uart, levels };
}

function character(uart, time, byte, bitTime = BIT, format = FORMATS["8N1"]) {
  const sender = new Sender(time, (level) => uart.level(level), () => {});
  sender.send(byte, bitTime, format);
  time.advanceTo(time.now + bitsOf(format) * bitTime);
}

test("a receiver reports a byte in the middle of its stop bit", () => {
  const time = new Time();
  const received = [];
  const receiver = new Receiver(time, (it) => received.push({ ...it, at: time.now }));
  receiver.bitTime = BIT;
  const sender = new Sender(time, (level) => receiver.level(level), () => {});
  sender.send(0xa5, BIT);
  time.advanceTo(20 * BIT);
  assert.deepEqual(received, [{ byte: 0xa5, good: true, rightParity: true, isBreak: false, at: 9.5 * BIT }]);
});

test("a receiver ignores a glitch, and reports a framing error if the sender has half its rate", () => {
  const time = new Time();
  const received = [];
  const receiver = new Receiver(time, (it) => received.push(it));
  receiver.bitTime = BIT;
  receiver.level(false);
  time.advanceTo(BIT / 4);
  receiver.level(true);
  time.advanceTo(20 * BIT);
  assert.equal(received.length, 0);
  const sender = new Sender(time, (level) => receiver.level(level), () => {});
  sender.send(0x00, 2 * BIT);
  time.advanceTo(40 * BIT);
  assert.equal(received[0].good, false);
});

test("a UART takes 10 bits for a byte, interrupts when its holding register is empty, and rejects a third byte", () => {
  const chip = setUp();
  const { uart } = uartOf(chip);
  uart.writeUint32(0x38, 1 << 5);
  uart.writeUint32(0x00, 0x55);
  assert.equal(uart.readUint32(0x40), 1 << 5);
  uart.writeUint32(0x44, 1 << 5);
  uart.writeUint32(0x00, 0xaa);
  assert.equal(uart.readUint32(0x40), 0);
  assert.throws(() => uart.writeUint32(0x00, 1), /no room/);
  chip.time.advanceTo(10 * BIT + 100);
  assert.equal(uart.readUint32(0x40), 1 << 5);
  assert.equal(uart.readUint32(0x18) & 8, 8, "the second byte is not over");
  chip.time.advanceTo(20 * BIT + 100);
  assert.equal(uart.readUint32(0x18) & 8, 0, "the second byte is over");
});

// Sends a byte in the format `sentIn`. Returns what a receiver in the format `format` reports, and the time at which
// the last stop bit ended.
function receivedIn(format, byte, sentIn) {
  const time = new Time();
  const received = [];
  const receiver = new Receiver(time, (it) => received.push({ ...it, at: time.now }));
  receiver.bitTime = BIT;
  receiver.format = FORMATS[format];
  const sender = new Sender(time, (level) => receiver.level(level), () => received.push({ sentAt: time.now }));
  sender.send(byte, BIT, FORMATS[sentIn]);
  time.advanceTo(20 * BIT);
  return received;
}

test("a character takes the bits of its format, and a receiver reports it in the middle of its first stop bit", () => {
  const middleOfStopBit = { "8N1": 9.5, "8N2": 9.5, "8E1": 10.5, "8O1": 10.5 };
  const ends = { "8N1": 10, "8N2": 11, "8E1": 11, "8O1": 11 };
  for (const format of Object.keys(FORMATS)) {
    for (const byte of [0x00, 0x01, 0x55, 0x57, 0xff]) {
      assert.deepEqual(receivedIn(format, byte, format), [
        { byte, good: true, rightParity: true, isBreak: false, at: middleOfStopBit[format] * BIT },
        { sentAt: ends[format] * BIT },
      ]);
    }
  }
});

test("a receiver reports wrong parity, and a low parity bit in place of the stop bit", () => {
  for (const [format, sentIn] of [["8E1", "8O1"], ["8O1", "8E1"]]) {
    const [{ byte, good, rightParity }] = receivedIn(format, 0x55, sentIn);
    assert.deepEqual({ byte, good, rightParity }, { byte: 0x55, good: true, rightParity: false });
  }
  assert.equal(receivedIn("8N1", 0x55, "8E1")[0].good, false);
  assert.equal(receivedIn("8N1", 0x57, "8E1")[0].good, true, "its parity bit is 1, like a stop bit");
  assert.equal(receivedIn("8N1", 0x55, "8N2")[0].good, true);
});

test("a UART takes its format from the line control register, reports wrong parity, and rejects other formats", () => {
  const values = { 0x60: "8N1", 0x62: "8O1", 0x66: "8E1", 0x68: "8N2" };
  for (const [value, format] of Object.entries(values)) {
    const chip = setUp();
    const { uart, levels } = uartOf(chip, false);
    uart.writeUint32(0x24, 67);
    uart.writeUint32(0x28, 52);
    uart.writeUint32(0x2c, Number(value));
    uart.writeUint32(0x30, 0x301);
    uart.writeUint32(0x00, 0x57);
    chip.time.advanceTo(20 * BIT);
    const parity = { "8E1": [true], "8O1": [false] }[format] ?? [];
    const stop = format === "8N2" ? [true, true] : [true];
    assert.deepEqual(levels, [false, true, true, true, false, true, false, true, false, ...parity, ...stop]);
    character(uart, chip.time, 0x57, BIT, FORMATS[format]);
    assert.equal(uart.readUint32(0x00), 0x57);
    if (parity.length !== 0) {
      character(uart, chip.time, 0x57, BIT, FORMATS[format === "8E1" ? "8O1" : "8E1"]);
      assert.equal(uart.readUint32(0x3c) & (1 << 8), 1 << 8);
      assert.equal(uart.readUint32(0x00), 0x57 | (1 << 9));
    }
  }
  const { uart } = uartOf(setUp(), false);
  assert.throws(() => uart.writeUint32(0x2c, 0x6e), /expected 8N1, 8N2, 8E1 or 8O1/);
});

test("a UART reports an overrun with the next byte, and a break as a framing error and a break", () => {
  const chip = setUp();
  const { uart } = uartOf(chip);
  character(uart, chip.time, 1);
  character(uart, chip.time, 2);
  assert.equal(uart.readUint32(0x3c) & (1 << 10), 1 << 10);
  assert.equal(uart.readUint32(0x00), 1);
  character(uart, chip.time, 3);
  assert.equal(uart.readUint32(0x00), 3 | (1 << 11));
  uart.level(false);
  chip.time.advanceTo(chip.time.now + 20 * BIT);
  uart.level(true);
  assert.equal(uart.readUint32(0x00), (1 << 8) | (1 << 10));
});

test("a UART with FIFOs raises interrupts at a FIFO level and at the receive timeout", () => {
  const chip = setUp();
  const { uart } = uartOf(chip, false);
  uart.writeUint32(0x24, 67);
  uart.writeUint32(0x28, 52);
  uart.writeUint32(0x2c, 0x70);
  uart.writeUint32(0x34, 0); // 1/8
  uart.writeUint32(0x30, 0x301);
  for (let byte = 0; byte < 3; byte += 1) {
    character(uart, chip.time, byte);
  }
  assert.equal(uart.readUint32(0x3c) & 0x50, 0);
  chip.time.advanceTo(chip.time.now + 33 * BIT);
  assert.equal(uart.readUint32(0x3c) & 0x50, 1 << 6, "timeout");
  character(uart, chip.time, 3);
  assert.equal(uart.readUint32(0x3c) & 0x50, (1 << 6) | (1 << 4));
  for (let byte = 0; byte < 4; byte += 1) {
    assert.equal(uart.readUint32(0x00), byte);
  }
  assert.equal(uart.readUint32(0x3c) & 0x50, 0);
});

test("a UART rejects accesses to its registers in a wrong order", () => {
  const { uart } = uartOf(setUp());
  assert.throws(() => uart.writeUint32(0x24, 1), /while the UART is enabled/);
  assert.throws(() => uart.readUint32(0x00), /nothing has been received/);
  const { uart: off } = uartOf(setUp(), false);
  assert.throws(() => off.writeUint32(0x00, 1), /transmitter is off/);
  off.writeUint32(0x24, 67);
  assert.throws(() => off.writeUint32(0x30, 0x301), /divisors have no effect/);
});

test("the flash takes time to erase, suspend and write, and rejects commands that it cannot execute", () => {
  const time = new Time();
  const flash = new FlashChip(time, new Uint8Array(FLASH_SIZE));
  const send = (...bytes) => {
    flash.select(true);
    const received = bytes.map((byte) => flash.exchange(byte));
    flash.select(false);
    return received;
  };
  assert.throws(() => send(0x20, 0x1f, 0, 0), /without Write Enable/);
  send(0x06);
  send(0x20, 0x1f, 0, 0);
  assert.equal(send(0x05, 0)[1] & 1, 1);
  assert.throws(() => send(0x03, 0, 0, 0, 0), /while the flash is busy/);
  flash.selected = false;
  time.advanceTo(20e6);
  send(0x75);
  assert.equal(send(0x05, 0)[1] & 1, 1, "a suspend takes 20 us");
  time.advanceTo(time.now + 19_000);
  assert.equal(send(0x05, 0)[1] & 1, 1);
  time.advanceTo(time.now + 1_000);
  assert.equal(send(0x05, 0)[1] & 1, 0);
  assert.equal(send(0x03, 0, 0, 0, 0)[4], 0);
  assert.throws(() => send(0x03, 0x1f, 0, 0, 0), /read in the sector whose erase is suspended/);
  flash.selected = false;
  send(0x06);
  assert.throws(() => send(0x02, 0x1f, 0, 0, 0), /program in the sector whose erase is suspended/);
  assert.throws(() => send(0x20, 0, 0, 0), /erase while another one is suspended/);
  flash.content[0x1e0000] = 0xff;
  send(0x02, 0x1e, 0, 0, 0x5a);
  assert.throws(() => send(0x7a), /resume while the flash is busy/);
  time.advanceTo(time.now + 399e3);
  assert.equal(send(0x05, 0)[1] & 1, 1, "writing a page takes 400 us");
  time.advanceTo(time.now + 1e3);
  assert.equal(send(0x03, 0x1e, 0, 0, 0)[4], 0x5a, "another sector can be programmed");
  send(0x7a);
  assert.throws(() => send(0x75), /too early/);
  time.advanceTo(time.now + 25e6 - 1000);
  assert.equal(send(0x05, 0)[1] & 1, 1);
  time.advanceTo(time.now + 1000);
  assert.equal(send(0x05, 0)[1] & 1, 0);
  assert.equal(send(0x03, 0x1f, 0, 0, 0)[4], 0xff);
  send(0x06);
  send(0x02, 0x1f, 0, 0, 0x0f);
  time.advanceTo(time.now + 400e3);
  send(0x06);
  send(0x02, 0x1f, 0, 0, 0xf3);
  time.advanceTo(time.now + 400e3);
  assert.equal(send(0x03, 0x1f, 0, 0, 0)[4], 0x03, "programming only clears bits");
});

test("the crystal is stable after its delay, and cannot be the reference clock before that", () => {
  const { mcu, time } = setUp();
  const crystal = new Crystal(mcu, "XOSC");
  requireStable(mcu.clocks, crystal);
  const stableAt = 1e6 + (0xc4 * 256 * 1e9) / 12e6;
  crystal.writeUint32(0, 0xfabaa0);
  time.advanceTo(stableAt - 1);
  assert.equal(crystal.readUint32(4), 0);
  assert.throws(() => mcu.clocks.writeUint32(0x30, 2), /before it is stable/);
  time.advanceTo(stableAt + 1);
  assert.equal(crystal.readUint32(4), 0x80000000);
  mcu.clocks.writeUint32(0x30, 2);
  assert.equal(mcu.clocks.refFreq, 12e6);
});

test("a power failure during an erase erases some bytes of the sector and leaves the others unchanged", () => {
  const time = new Time();
  const flash = new FlashChip(time, new Uint8Array(FLASH_SIZE));
  flash.writeEnabled = true;
  flash.begin("erase", 0x1f0000, []);
  flash.losePower();
  const sector = flash.content.subarray(0x1f0000, 0x1f1000);
  assert.ok(sector.includes(0) && sector.includes(0xff));
});

test("the SSI takes time for each frame, and rejects frames before its set-up and new settings while enabled", () => {
  const { mcu, time } = setUp();
  const flash = new FlashChip(time, new Uint8Array(FLASH_SIZE).fill(0x5a));
  const pins = new QspiPins(mcu, "IO_QSPI", flash);
  const ssi = new Ssi(mcu, "SSI", flash, pins);
  assert.throws(() => ssi.writeUint32(0x60, 0), /before the SSI is set up/);
  ssi.writeUint32(0x14, 4);
  ssi.writeUint32(0x00, (31 << 16) | (3 << 8));
  ssi.writeUint32(0x04, 1);
  ssi.writeUint32(0x10, 1);
  ssi.writeUint32(0x08, 1);
  assert.throws(() => ssi.writeUint32(0x14, 2), /while the SSI is enabled/);
  ssi.writeUint32(0x60, 0x03000000);
  const frame = (32 * 4 * 1e9) / mcu.clkSys;
  time.advanceTo(3 * frame - 1);
  assert.equal(ssi.readUint32(0x24), 1);
  time.advanceTo(3 * frame + 1);
  assert.equal(ssi.readUint32(0x24), 2);
  assert.equal(ssi.readUint32(0x60), 0x5a5a5a5a);
  assert.equal(flash.selected, false);
  mcu.clkSys = 201e6;
  assert.throws(() => ssi.writeUint32(0x60, 0x03000000), /50.25 MHz; expected at most 50 MHz/);
});

test("a block in reset cannot be used, and a UART without its clock does not leave its reset", () => {
  const { mcu } = setUp();
  const inReset = [];
  const resets = new Resets(mcu, "RESETS", (blocks) => inReset.push(blocks));
  const uart = 1 << 22;
  const guarded = new Guarded({ readUint32: () => 7 }, "uart", () => (resets.held & uart ? "it is held in reset" : ""));
  assert.throws(() => guarded.readUint32(0), /held in reset/);
  resets.writeUint32(0, resets.held & ~uart);
  assert.equal(guarded.readUint32(0), 7);
  assert.equal(resets.readUint32(8) & uart, 0, "its clock does not run");
  resets.writeUint32(0, resets.held | uart);
  assert.deepEqual(inReset, [0, uart]);
});

test("the watchdog counts two for each tick, requires a tick, and rejects a reset of only a part of the chip", () => {
  const { mcu, time } = setUp();
  const psm = { wdsel: 0 };
  const reasons = [];
  const watchdog = new Watchdog(mcu, "WATCHDOG", psm, {
    reason: 0, scratch: new Uint32Array(8), reset: (reason) => reasons.push(reason),
  });
  mcu.clocks.refCtrl = 2; // the crystal
  watchdog.writeUint32(0x04, 2_000_000);
  watchdog.writeUint32(0x00, 1 << 30);
  time.advanceTo(5e9);
  assert.deepEqual(reasons, [], "there is no tick");
  watchdog.writeUint32(0x2c, (1 << 9) | 12);
  watchdog.writeUint32(0x04, 2_000_000);
  assert.throws(() => time.advanceTo(time.now + 2e9), /WDSEL .* omits parts/);
  psm.wdsel = 0x1fffc;
  watchdog.writeUint32(0x04, 2_000_000);
  const fed = time.now;
  time.advanceTo(fed + 1e9 - 1);
  assert.deepEqual(reasons, []);
  time.advanceTo(fed + 1e9);
  assert.deepEqual(reasons, [1]);
});

test("the watchdog keeps its scratch registers, and the source of a chip-level reset is read-only", () => {
  const { mcu } = setUp();
  const scratch = new Uint32Array(8);
  new Watchdog(mcu, "WATCHDOG", {}, { reason: 0, scratch }).writeUint32(0x28, 9);
  assert.equal(new Watchdog(mcu, "WATCHDOG", {}, { reason: 1, scratch }).readUint32(0x28), 9);
  const chipReset = new ChipReset(mcu, "CHIP_RESET", CHIP_RESET.run);
  assert.equal(chipReset.readUint32(8), 0x10000);
  assert.throws(() => chipReset.writeUint32(8, 0));
});

test("an I2C master reports a nearly empty queue and rejects untimely accesses; an EEPROM write takes 5 ms", () => {
  const { mcu, time } = setUp();
  const master = mcu.i2c[0];
  correctI2c(master);
  const eeprom = new Eeprom(time);
  eeprom.attach(master, mcu.clock, () => 10_000, () => true);
  assert.throws(() => master.writeUint32(0x10, 0), /while the master is off/);
  master.writeUint32(0x04, 0x50);
  master.writeUint32(0x6c, 1);
  assert.throws(() => master.writeUint32(0x04, 0x51), /while the master is on/);
  assert.equal(master.readUint32(0x34) & 0x10, 0x10);
  [0, 0, 0x42 | 0x200].forEach((command) => master.writeUint32(0x10, command));
  time.advanceTo(time.now + 400_000);
  assert.equal(master.readUint32(0x34) & 0x200, 0x200, "STOP");
  assert.equal(eeprom.content[0], 0xff);
  time.advanceTo(time.now + 4.5e6); // the write cycle began during the 400 us
  assert.equal(eeprom.content[0], 0xff);
  time.advanceTo(time.now + 0.5e6);
  assert.equal(eeprom.content[0], 0x42);
  master.writeUint32(0x6c, 0);
  const control = master.readUint32(0x00);
  master.writeUint32(0x00, control & ~0x40);
  master.writeUint32(0x6c, 1);
  assert.throws(() => master.writeUint32(0x10, 0), /the slave is enabled/);
  master.writeUint32(0x6c, 0);
  master.writeUint32(0x00, control);
  master.writeUint32(0x04, 0x51);
  master.writeUint32(0x6c, 1);
  master.writeUint32(0x10, 0x200);
  time.advanceTo(time.now + 400_000);
  assert.throws(() => master.writeUint32(0x10, 0), /before the abort is cleared/);
  master.readUint32(0x40); // clears the flags, but the queue still discards commands
  assert.throws(() => master.writeUint32(0x10, 0), /before the abort is cleared/);
  master.readUint32(0x54);
  master.writeUint32(0x10, 0);
});

test("a pending interrupt wakes the processor even if PRIMASK prevents its handler from running", () => {
  const { mcu } = setUp();
  const { core } = mcu;
  const processor = new Processor(mcu);
  const WFI = 0xbf30;
  const NOP = 0xbf00;
  mcu.sramView.setUint16(0x100, WFI, true);
  mcu.sramView.setUint16(0x102, NOP, true);
  mcu.sramView.setUint32(4 * 16, 0x20000201, true);
  core.VTOR = 0x20000000;
  core.SP = 0x20001000;
  core.PC = 0x20000100;
  core.PM = true;
  core.enabledInterrupts = 1;
  processor.setLine(0, true);
  processor.step();
  assert.equal(core.PC, 0x20000102);
  processor.step();
  assert.equal(core.PC, 0x20000104, "the handler has not run");
  core.PM = false;
  core.interruptsUpdated = true;
  processor.step();
  assert.equal(core.IPSR, 16);
});

test("the PLL requires a reference, and cannot clock the system without a lock or with its dividers off", () => {
  const { time, mcu } = setUp();
  const pll = mcu.peripherals[0x40028];
  const crystal = { stable: false };
  correctPll(pll, crystal, mcu.clocks);
  const isLocked = () => (pll.readUint32(0) & (1 << 31)) !== 0;
  pll.writeUint32(0, 1);
  assert.throws(() => pll.writeUint32(4, 0x0c), /without a reference/);
  crystal.stable = true;
  pll.writeUint32(4, 0x2d);
  assert.throws(() => pll.writeUint32(4, 0x0c), /0 Hz/);
  pll.writeUint32(4, 0x2d);
  pll.writeUint32(8, 125);
  assert.equal(isLocked(), false);
  pll.writeUint32(4, 0x0c);
  assert.equal(isLocked(), false);
  assert.throws(() => mcu.clocks.writeUint32(0x3c, 1), /before it runs/);
  time.advanceTo(time.now + 50_000);
  assert.equal(isLocked(), true);
  assert.throws(() => pll.writeUint32(8, 100), /set up while it runs/);
  assert.throws(() => mcu.clocks.writeUint32(0x3c, 1), /before it runs/, "the dividers have no power");
  pll.writeUint32(4, 0x04);
  mcu.clocks.writeUint32(0x3c, 1);
  assert.throws(() => pll.reset(), /reset while it is the system clock/);
  mcu.clocks.writeUint32(0x3c, 0);
  pll.reset();
  assert.equal(pll.readUint32(4), 0x2d);
  assert.equal(isLocked(), false);
});
