// Tests that the models reject an access that is an error on a real chip. The images and transcripts test what the
// models do otherwise.
"use strict";
const assert = require("node:assert/strict");
const { test } = require("node:test");
const { RP2040 } = require("rp2040js");
const { ChipClock, Time } = require("./clock");
const { Crystal, requireStable } = require("./crystal");
const { Eeprom } = require("./eeprom");
const { FLASH_SIZE, FlashChip } = require("./flash_chip");
const { correctI2c } = require("./i2c");
const { Pl011 } = require("./pl011");
const { correctPll } = require("./pll");
const { QspiPins, Ssi } = require("./ssi");
const { Guarded, Resets, Watchdog } = require("./system");

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
  const uart = new Pl011(mcu, "UART0", 20, {
    transmit: () => {},
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
  return { uart };
}

test("a UART rejects accesses to its registers in a wrong order, a third byte, and other formats", () => {
  const { uart } = uartOf(setUp());
  assert.throws(() => uart.writeUint32(0x24, 1), /while the UART is enabled/);
  assert.throws(() => uart.readUint32(0x00), /nothing has been received/);
  uart.writeUint32(0x00, 0x55);
  uart.writeUint32(0x00, 0xaa);
  assert.throws(() => uart.writeUint32(0x00, 1), /no room/);
  const { uart: off } = uartOf(setUp(), false);
  assert.throws(() => off.writeUint32(0x00, 1), /transmitter is off/);
  off.writeUint32(0x24, 67);
  assert.throws(() => off.writeUint32(0x30, 0x301), /divisors have no effect/);
  assert.throws(() => off.writeUint32(0x2c, 0x6e), /expected 8N1, 8N2, 8E1 or 8O1/);
});

test("the flash rejects commands that it cannot execute, and programming only clears bits", () => {
  const time = new Time();
  const flash = new FlashChip(time, new Uint8Array(FLASH_SIZE));
  const send = (...bytes) => {
    flash.select(true);
    const received = bytes.map((byte) => flash.exchange(byte));
    flash.select(false);
    return received;
  };
  const busy = () => (send(0x05, 0)[1] & 1) === 1;
  assert.throws(() => send(0x20, 0x1f, 0, 0), /without Write Enable/);
  send(0x06);
  send(0x20, 0x1f, 0, 0);
  assert.throws(() => send(0x03, 0, 0, 0, 0), /while the flash is busy/);
  flash.selected = false;
  time.advanceTo(20e6);
  send(0x75);
  time.advanceTo(time.now + 19_000);
  assert.ok(busy(), "a suspend takes 20 us");
  time.advanceTo(time.now + 1_000);
  assert.ok(!busy());
  assert.throws(() => send(0x03, 0x1f, 0, 0, 0), /read in the sector whose erase is suspended/);
  flash.interrupt();
  assert.doesNotThrow(() => send(0x03, 0x1f, 0, 0, 0), "after a reset, nobody knows which sector it is");
  send(0x06);
  assert.throws(() => send(0x02, 0x1f, 0, 0, 0), /program in the sector whose erase is suspended/);
  assert.throws(() => send(0x20, 0, 0, 0), /erase while another one is suspended/);
  send(0x02, 0x1e, 0, 0, 0x5a);
  assert.throws(() => send(0x7a), /resume while the flash is busy/);
  time.advanceTo(time.now + 400e3);
  send(0x7a);
  assert.throws(() => send(0x75), /too early/);
  time.advanceTo(time.now + 25e6);
  assert.ok(!busy());
  for (const byte of [0x0f, 0xf3]) {
    send(0x06);
    send(0x02, 0x1f, 0, 0, byte);
    time.advanceTo(time.now + 400e3);
  }
  assert.equal(send(0x03, 0x1f, 0, 0, 0)[4], 0x03);
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

test("the SSI rejects frames before its set-up, new settings while enabled, and a clock that is too fast", () => {
  const { mcu } = setUp();
  const flash = new FlashChip(new Time(), new Uint8Array(FLASH_SIZE));
  const ssi = new Ssi(mcu, "SSI", flash, new QspiPins(mcu, "IO_QSPI", flash));
  assert.throws(() => ssi.writeUint32(0x60, 0), /before the SSI is set up/);
  ssi.writeUint32(0x14, 4);
  ssi.writeUint32(0x00, (31 << 16) | (3 << 8));
  ssi.writeUint32(0x04, 1);
  ssi.writeUint32(0x10, 1);
  ssi.writeUint32(0x08, 1);
  assert.throws(() => ssi.writeUint32(0x14, 2), /while the SSI is enabled/);
  mcu.clkSys = 201e6;
  assert.throws(() => ssi.writeUint32(0x60, 0x03000000), /50.25 MHz; expected at most 50 MHz/);
  ssi.writeUint32(0x08, 0);
  ssi.writeUint32(0x00, 7 << 16);
  ssi.writeUint32(0x08, 1);
  flash.select(true);
  assert.throws(() => ssi.writeUint32(0x60, 0x03), /50.25 MHz; expected at most 50 MHz/);
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

test("an I2C master rejects untimely accesses", () => {
  const { mcu, time } = setUp();
  const master = mcu.i2c[0];
  correctI2c(master);
  const eeprom = new Eeprom(time);
  eeprom.attach(master, mcu.clock, () => 10_000, () => true);
  assert.throws(() => master.writeUint32(0x10, 0), /while the master is off/);
  master.writeUint32(0x04, 0x50);
  master.writeUint32(0x6c, 1);
  assert.throws(() => master.writeUint32(0x04, 0x51), /while the master is on/);
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
