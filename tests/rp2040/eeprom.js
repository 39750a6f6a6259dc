// An AT24C64 on the I2C master of rp2040js, byte by byte. Source: Atmel AT24C64 data sheet (doc. 0336), "write
// operations" and "read operations".
"use strict";

const SIZE = 8192;
const PAGE = 32;
const DEVICE = 0x50;
const PROGRAMMING = 5e6; // ns; the data sheet permits at most 10 ms
const BITS = 9; // a byte and its acknowledge

class Eeprom {
  constructor(time) {
    this.time = time;
    this.content = new Uint8Array(SIZE).fill(0xff);
    this.present = true;
    this.programs = null; // pairs [address, value] that are being programmed, or null
    this.alarm = time.createAlarm(() => this.programmed());
    this.pagesProgrammed = 0;
    this.changed = () => {}; // is called with the first address and the number of the bytes that may have changed
    this.address = 0;
    this.reset();
  }

  // Discards the transfer on the bus.
  reset() {
    this.written = [];
    this.addressed = false;
  }

  // Connects to the I2C master of a chip. `bitTime()` returns the duration of a bit in nanoseconds. `connected()`
  // returns whether the pins are connected to the master.
  attach(master, clock, bitTime, connected) {
    const later = (bits, act) => {
      const alarm = clock.createAlarm(() => {
        clock.time.alarms.delete(alarm);
        act();
      });
      alarm.schedule(bits * bitTime());
    };
    Object.assign(master, {
      onStart: () => later(1, () => {
        this.reset();
        master.completeStart();
      }),
      onConnect: (device) => later(BITS, () => {
        this.addressed = this.present && connected() && device === DEVICE && this.programs === null;
        master.completeConnect(this.addressed);
      }),
      onWriteByte: (byte) => later(BITS, () => {
        this.written.push(byte);
        if (this.written.length === 2) {
          this.address = ((this.written[0] << 8) | byte) % SIZE;
        }
        master.completeWrite(true);
      }),
      onReadByte: () => later(BITS, () => {
        const byte = this.content[this.address];
        this.address = (this.address + 1) % SIZE;
        master.completeRead(byte);
      }),
      onStop: () => later(1, () => {
        this.stop();
        master.completeStop();
      }),
    });
  }

  stop() {
    const data = this.written.slice(2);
    if (!this.addressed || data.length === 0) {
      return;
    }
    const page = this.address - (this.address % PAGE);
    const cells = new Map();
    data.forEach((byte, index) => cells.set(page + ((this.address - page + index) % PAGE), byte));
    this.address = page + ((this.address - page + data.length) % PAGE);
    this.programs = [...cells];
    this.began = this.time.now;
    this.alarm.schedule(PROGRAMMING);
  }

  programmed() {
    this.programs.forEach(([address, byte]) => {
      this.content[address] = byte;
    });
    this.programs = null;
    this.pagesProgrammed += 1;
    this.changed(0, SIZE);
  }

  // Simulates a power failure. If bytes are being programmed, the first of these bytes get their new values, the next
  // byte is corrupted, and the other bytes keep their old values. The number of bytes with new values is proportional
  // to the time since the programming began.
  losePower() {
    if (this.programs !== null) {
      const part = Math.floor(((this.time.now - this.began) / PROGRAMMING) * this.programs.length);
      this.programs.slice(0, part + 1).forEach(([address, byte], index) => {
        this.content[address] = index < part ? byte : byte ^ 0xa5;
      });
      this.alarm.cancel();
      this.programs = null;
      this.changed(0, SIZE);
    }
    this.reset();
  }
}

module.exports = { Eeprom, EEPROM_SIZE: SIZE };
