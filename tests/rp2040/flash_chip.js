// A W25Q16JV flash chip at byte level. Source: Winbond W25Q16JV data sheet (revision H), 8.2 (instructions) and 9.6
// (times).
"use strict";

const SIZE = 2 * 1024 * 1024;
const PAGE = 256;
const SECTOR = 4096;
const SUSPEND = 20_000; // ns, the largest tSUS, and the shortest time from a resume to the next suspend

const UNIQUE_ID = [0xe4, 0x61, 0x64, 0x10, 0x43, 0x8e, 0x2a, 0x31]; // arbitrary

class FlashChip {
  // `content` has 2 MiB; this object changes it. `times` contains the durations { erase, program } in nanoseconds.
  constructor(time, content, times = { erase: 45e6, program: 400e3 }) {
    this.time = time;
    this.content = content;
    this.times = times;
    this.selected = false;
    this.bytes = [];
    this.writeEnabled = false;
    this.operation = null; // the operation that is running: { kind, address, bytes, sector, left }, or null
    this.ends = 0; // time at which the operation ends
    this.suspended = null; // the erase that is suspended, or null
    this.forgotten = null; // the operation that was running or suspended at the last reset, which does not know it
    this.suspending = 0; // time at which the last suspend takes effect
    this.resumed = -Infinity; // time of the last resume
    this.erased = new Map(); // number of erases, by sector
    this.stuck = new Set(); // addresses of bytes that a program operation does not change
    this.done = time.createAlarm(() => this.finish());
    this.changed = () => {}; // is called with the first address and the number of the bytes that have changed
  }

  get busy() {
    return this.operation !== null || this.time.now < this.suspending;
  }

  select(on) {
    if (this.selected && !on) {
      this.execute();
    }
    this.selected = on;
    this.bytes = [];
  }

  // Simulates a reset of the microcontroller, which releases chip select. The command that the chip is receiving takes
  // effect only if it is a complete erase or program command.
  interrupt() {
    const [command] = this.bytes;
    if (this.selected && (this.bytes.length > 4 || (command === 0x20 && this.bytes.length === 4))) {
      this.execute();
    }
    this.selected = false;
    this.bytes = [];
    this.forgotten = this.suspended ?? this.operation;
  }

  // Takes a byte and returns the byte that the chip sends at the same time.
  exchange(byte) {
    if (!this.selected) {
      return 0xff;
    }
    this.bytes.push(byte);
    const [command] = this.bytes;
    if (this.busy && ![0x05, 0x75, 0x7a].includes(command)) {
      throw new Error(`flash: command 0x${command.toString(16)} arrives while the flash is busy; `
        + "expected 0x5, 0x75 or 0x7a");
    }
    if (command === 0x05) {
      return (this.busy ? 1 : 0) | (this.writeEnabled ? 2 : 0);
    }
    if (command === 0x4b && this.bytes.length > 5) {
      return UNIQUE_ID[(this.bytes.length - 6) % UNIQUE_ID.length];
    }
    if (command === 0x03 && this.bytes.length > 4) {
      const address = (this.address() + this.bytes.length - 5) % SIZE;
      if (this.isSuspended(address) && this.suspended.begun === this.forgotten?.begun) {
        return (address * 0x9e3779b1) >>> 24; // undefined
      }
      this.rejectSuspended(address, "read");
      return this.content[address];
    }
    return 0xff;
  }

  address() {
    return ((this.bytes[1] << 16) | (this.bytes[2] << 8) | this.bytes[3]) % SIZE;
  }

  execute() {
    const [command, ...data] = this.bytes;
    switch (command) {
    case undefined:
    case 0x03:
    case 0x05:
    case 0x4b:
      break;
    case 0x06:
      this.writeEnabled = true;
      break;
    case 0x02:
      this.begin("program", this.address(), data.slice(3));
      break;
    case 0x20:
      this.begin("erase", this.address(), data.slice(3));
      break;
    case 0x75:
      this.suspend();
      break;
    case 0x7a:
      this.resume();
      break;
    default:
      throw new Error(`flash: command 0x${command.toString(16)} is not in this model`);
    }
  }

  isSuspended(address) {
    return this.suspended !== null && Math.floor(address / SECTOR) === this.suspended.sector;
  }

  // Rejects an access to the sector whose erase is suspended.
  rejectSuspended(address, access) {
    if (this.isSuspended(address)) {
      throw new Error(`flash: ${access} in the sector whose erase is suspended`);
    }
  }

  begin(kind, address, bytes) {
    if (!this.writeEnabled) {
      throw new Error(`flash: ${kind} without Write Enable`);
    }
    if (kind === "erase" && this.suspended !== null) {
      throw new Error("flash: erase while another one is suspended");
    }
    this.rejectSuspended(address, kind);
    if (kind === "program" ? bytes.length === 0 || bytes.length > PAGE - (address % PAGE) : bytes.length !== 0) {
      const expected = kind === "program" ? `1 to ${PAGE - (address % PAGE)}, up to the end of the page` : "none";
      const place = `flash: ${kind} at 0x${address.toString(16)}`;
      throw new Error(`${place}: has ${bytes.length} data bytes; expected ${expected}`);
    }
    const sector = Math.floor(address / SECTOR);
    this.run({ kind, address, bytes, sector, left: this.times[kind], begun: this.time.now });
  }

  run(operation) {
    this.operation = operation;
    this.ends = this.time.now + operation.left;
    this.done.scheduleAt(this.ends);
  }

  finish() {
    const { kind, address, bytes, sector } = this.operation;
    if (kind === "erase") {
      this.content.fill(0xff, sector * SECTOR, (sector + 1) * SECTOR);
      this.erased.set(sector, (this.erased.get(sector) ?? 0) + 1);
    } else {
      bytes.forEach((byte, index) => {
        this.content[address + index] &= this.stuck.has(address + index) ? 0xff : byte;
      });
    }
    this.changed(kind === "erase" ? sector * SECTOR : address, kind === "erase" ? SECTOR : bytes.length);
    this.operation = null;
    this.writeEnabled = false;
  }

  suspend() {
    if (this.operation === null) {
      return;
    }
    if (this.operation.kind !== "erase") {
      throw new Error("flash: suspend during a program operation is not in this model");
    }
    if (this.time.now - this.resumed < SUSPEND) {
      throw new Error("flash: suspend too early after resume");
    }
    this.suspended = { ...this.operation, left: this.ends - this.time.now };
    this.operation = null;
    this.done.cancel();
    this.suspending = this.time.now + SUSPEND;
  }

  resume() {
    if (this.suspended !== null) {
      if (this.busy) {
        throw new Error("flash: resume while the flash is busy");
      }
      this.run(this.suspended);
      this.suspended = null;
      this.resumed = this.time.now;
    }
  }

  // Simulates a power failure. On a real chip, the bytes of an unfinished operation are then undefined. In this model,
  // the bytes 0, 2, 4 and so on of the operation get their new values, and its other bytes keep their old values.
  losePower() {
    for (const unfinished of [this.operation, this.suspended].filter((each) => each !== null)) {
      const { kind, address, bytes, sector } = unfinished;
      const size = kind === "erase" ? SECTOR : bytes.length;
      const first = kind === "erase" ? sector * SECTOR : address;
      for (let index = 0; index < size; index += 2) {
        this.content[first + index] = kind === "erase" ? 0xff : this.content[first + index] & bytes[index];
      }
      this.changed(first, size);
    }
    this.done.cancel();
    this.operation = null;
    this.suspended = null;
    this.suspending = 0;
    this.resumed = -Infinity;
    this.writeEnabled = false;
    this.selected = false;
  }
}

module.exports = { FlashChip, FLASH_SIZE: SIZE };
