// A module with a Pico: pins, transceiver, flash, EEPROM, supply, and the master's end of the line.
"use strict";
const { ChipClock, Time } = require("./clock");
const { Chip } = require("./chip");
const { Eeprom } = require("./eeprom");
const { FLASH_SIZE, FlashChip } = require("./flash_chip");
const { FORMATS, Receiver, Sender } = require("./line");
const { CHIP_RESET, REASON, SCRATCH_REGISTERS } = require("./system");

const PINS = 30;
const PULL = 700e3; // ns until a pull has changed the level of an open pin: 80 kΩ and a wire of 9 nF

class Board {
  // `image` is the content of the flash from its first byte on. `pins` contains the numbers of the pins transmit,
  // receive, driverEnable and data (SDA; SCL is the next pin). If driverEnable is null, the transceiver switches its
  // direction automatically.
  constructor(image, pins) {
    this.time = new Time();
    this.pins = pins;
    this.flash = new FlashChip(this.time, new Uint8Array(FLASH_SIZE).fill(0xff));
    this.flash.content.set(image);
    this.eeprom = new Eeprom(this.time);
    // The level to which parts outside the chip drive each pin; null if no such part drives the pin.
    this.outside = new Array(PINS).fill(null);
    this.outside[pins.data] = true; // pull-ups
    this.outside[pins.data + 1] = true;
    this.chip = null;
    this.transmitted = true;
    this.driverOn = false;
    this.echoes = true;
    this.masterLevel = true;
    this.queue = [];
    this.heard = [];
    this.masterBitTime = 1e9 / 9600;
    this.masterFormat = FORMATS["8N1"];
    this.master = new Sender(this.time, (level) => this.masterDrives(level), () => this.sendNext());
    this.listener = new Receiver(this.time, (character) => this.hear(character));
    this.listener.bitTime = this.masterBitTime;
    this.stopWanted = false;
    this.watched = null;
    this.counts = { timeouts: 0, requests: 0, lost: 0, early: 0, late: 0, shorts: 0, drives: 0, framing: 0,
      parity: 0 };
    this.lastStop = 0;
    this.levels = new Array(PINS).fill(false);
    this.pulls = this.levels.map((_, number) => this.time.createAlarm(
      () => this.setLevel(number, this.target(number))));
  }

  // --- supply and resets ---

  power(on) {
    if (on && this.chip === null) {
      this.startCold(CHIP_RESET.supply);
    } else if (!on && this.chip !== null) {
      this.end();
      this.flash.losePower();
      this.eeprom.losePower();
    }
  }

  // Resets the chip with its RUN pin.
  reset() {
    if (this.chip !== null) {
      this.end();
      this.startCold(CHIP_RESET.run);
    }
  }

  // Resets only the processor, as a debug probe does. All other parts of the chip keep their state.
  resetProcessor() {
    this.chip?.resetProcessor();
  }

  // Starts the chip in the state that it has after an image has been copied to the drive RPI-RP2: the boot ROM has
  // reset the chip with the watchdog.
  startAfterCopy() {
    this.startCold(CHIP_RESET.supply, REASON.timeout);
  }

  // Starts the chip after the chip-level reset `chipReset`, which clears the scratch registers. `reason` is the reason
  // of a watchdog reset that has followed, if there was one.
  startCold(chipReset, reason = REASON.none) {
    this.chipReset = chipReset;
    this.scratch = new Uint32Array(SCRATCH_REGISTERS);
    this.start(reason);
  }

  start(reason) {
    this.clock = new ChipClock(this.time);
    this.reason = reason;
    this.resetWanted = null;
    this.transmitted = true;
    this.chip = new Chip({
      clock: this.clock,
      flash: this.flash,
      pins: this.pins,
      reason,
      chipReset: this.chipReset,
      scratch: this.scratch,
      transmitted: true,
      transmit: (level) => this.transmit(level),
      pinChanged: (number) => this.pinChanged(number),
      reset: (why) => {
        this.resetWanted = why;
      },
    });
    const { chip } = this;
    this.eeprom.attach(chip.i2c, this.clock, () => chip.i2cBitTime, () => chip.i2cConnected);
    for (let number = 0; number < PINS; number += 1) {
      this.pinChanged(number);
    }
  }

  end() {
    this.clock.end();
    this.chip = null;
    this.driverOn = false;
    this.pulls.forEach((pull) => pull.cancel());
    this.flash.interrupt();
    this.eeprom.reset();
    for (let number = 0; number < PINS; number += 1) {
      this.levels[number] = this.outside[number] ?? false;
    }
    this.updateLine();
  }

  // --- time ---

  // Lets time pass up to the time `until` (in nanoseconds), or until `stopWanted` becomes true.
  runUntil(until) {
    const { time } = this;
    this.stopWanted = false;
    while (time.now < until && !this.stopWanted) {
      if (this.chip === null) {
        time.advanceTo(Math.min(until, time.next));
      } else {
        this.runChip(until);
        if (this.resetWanted !== null) {
          const reason = this.resetWanted;
          this.counts[reason === REASON.timeout ? "timeouts" : "requests"] += 1;
          this.end();
          this.start(reason);
        }
      }
    }
    this.checkPins();
  }

  runChip(until) {
    const { time } = this;
    const { mcu, processor } = this.chip;
    while (time.now < until && !this.stopWanted && this.resetWanted === null) {
      const cycles = processor.step();
      if (cycles === 0) {
        time.advanceTo(Math.min(until, time.next));
      } else {
        const to = time.now + (cycles * 1e9) / mcu.clkSys;
        if (to < time.next) {
          time.now = to;
        } else {
          time.advanceTo(to);
        }
      }
    }
  }

  // --- pins ---

  setOutside(number, level) {
    this.outside[number] = level;
    this.pinChanged(number);
  }

  pinChanged(number) {
    const { chip } = this;
    if (chip === null || chip === undefined) {
      this.levels[number] = this.outside[number] ?? false;
      return;
    }
    const own = chip.level(number);
    const outside = this.outside[number];
    const isBus = number === this.pins.data || number === this.pins.data + 1;
    if (own !== null && outside !== null && own !== outside && !isBus) {
      this.counts.shorts += 1;
    }
    if (own !== null || outside !== null || this.target(number) === this.levels[number]) {
      this.pulls[number].cancel();
      this.setLevel(number, this.target(number));
    } else if (!this.pulls[number].scheduled) {
      this.pulls[number].schedule(PULL);
    }
  }

  // Returns the level that the pin finally reaches. A pull changes the level only after the time PULL.
  target(number) {
    return this.chip.level(number) ?? this.outside[number] ?? this.chip.pull(number) ?? false;
  }

  setLevel(number, level) {
    const { chip } = this;
    const pin = chip.mcu.gpio[number];
    this.levels[number] = level;
    if (pin.rawInputValue !== level) {
      pin.setInputValue(level);
    }
    if (number === this.pins.driverEnable) {
      this.enableDriver(level);
    } else if (number === this.pins.transmit && this.automatic) {
      this.driveAutomatically(level);
    } else if (number === this.pins.receive) {
      chip.uart.level(level);
    }
    if (this.watched !== null && number === this.watched.number && level !== this.watched.level) {
      this.stopWanted = true;
    }
  }

  // Rejects an enabled input that floats, because its level is undefined.
  checkPins() {
    if (this.chip === null) {
      return;
    }
    this.chip.mcu.gpio.forEach((pin, number) => {
      const floats = this.chip.level(number) === null && this.outside[number] === null
        && this.chip.pull(number) === null;
      if (floats && pin.inputEnable) {
        throw new Error(`GPIO${number}: the enabled input floats; expected a pull, or a part that drives the pin`);
      }
    });
  }

  // --- the line ---

  transmit(level) {
    if (this.chip.uart.sender.atStartBit && !this.driverOn && !this.automatic) {
      this.counts.lost += 1;
    }
    this.transmitted = level;
    this.chip.board.transmitted = level;
    this.lastStop = this.time.now + this.chip.uart.bitTime;
    this.pinChanged(this.pins.transmit);
    this.updateLine();
  }

  enableDriver(on) {
    if (on === this.driverOn) {
      return;
    }
    this.driverOn = on;
    this.stopWanted = !on || this.stopWanted;
    if (on) {
      this.counts.drives += 1;
    } else if (this.chip.uart.sender.busy) {
      this.counts.early += 1;
    } else if (this.time.now - this.lastStop > this.chip.uart.characterTime) {
      this.counts.late += 1;
    }
    this.updateLine();
  }

  get automatic() {
    return this.pins.driverEnable === null;
  }

  // An automatic transceiver drives only zeros, even those of a transmit pin that floats low after a reset. The biasing
  // of the line makes the ones.
  driveAutomatically(level) {
    this.driverOn = !level;
    this.transmitted = level;
    this.updateLine();
  }

  // Returns whether the module sends, for a master that waits for the end.
  get speaks() {
    return this.automatic ? this.chip !== null && this.chip.uart.sender.busy : this.driverOn;
  }

  masterDrives(level) {
    this.masterLevel = level;
    this.updateLine();
  }

  updateLine() {
    const driven = this.chip !== null && this.driverOn;
    const line = (!driven || this.transmitted) && this.masterLevel;
    if (!this.master.busy) {
      this.listener.level(line);
    }
    const heard = driven && !this.echoes ? true : line;
    if (this.outside[this.pins.receive] !== heard) {
      this.setOutside(this.pins.receive, heard);
    }
  }

  // --- the master ---

  setBaud(baud) {
    this.masterBitTime = 1e9 / baud;
    this.listener.bitTime = this.masterBitTime;
  }

  setFormat(name) {
    if (!Object.hasOwn(FORMATS, name)) {
      throw new Error(`format ${name}: there is no such line format; expected 8N1, 8N2, 8E1 or 8O1`);
    }
    this.masterFormat = FORMATS[name];
    this.listener.format = this.masterFormat;
  }

  send(bytes) {
    this.queue.push(...bytes);
    if (!this.master.busy) {
      this.sendNext();
    }
  }

  sendNext() {
    if (this.queue.length === 0) {
      this.stopWanted = true;
      return;
    }
    this.listener.stop();
    this.master.send(this.queue.shift(), this.masterBitTime, this.masterFormat);
  }

  hear({ byte, good, rightParity }) {
    this.heard.push({ byte, at: this.time.now });
    this.counts.framing += good ? 0 : 1;
    this.counts.parity += rightParity ? 0 : 1;
    this.stopWanted = true;
  }

  takeHeard(count = this.heard.length) {
    return this.heard.splice(0, count);
  }
}

module.exports = { Board };
