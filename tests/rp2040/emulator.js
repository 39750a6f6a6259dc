// Runs an image for the Pico in virtual time. Each line on standard input is a command. The reply is one line on
// standard output: "ok" and the result, or "error" and the reason.
"use strict";
const fs = require("fs");
const { Board } = require("./board");

const STEP = 1e4; // ns
let board = null;

const integer = (text) => {
  const value = Number(text);
  if (!Number.isSafeInteger(value)) {
    throw new Error(`${text}: the argument is wrong; expected an integer of at most 2^53 - 1`);
  }
  return value;
};
const hexOf = (bytes) => Buffer.from(bytes).toString("hex");
const bytesOf = (text) => [...Buffer.from(text ?? "", "hex")];

// Copies the content of an open file to a memory, from `address` on. If the image or a power failure later changes
// these bytes of the memory, the memory writes them to the file. The commands `memory` and `set-flash` do not write to
// the file.
function keep(memory, descriptor, address) {
  const { size } = fs.fstatSync(descriptor);
  fs.readSync(descriptor, memory.content, address, size, 0);
  Object.assign(memory, {
    changed(first, count) {
      const begin = Math.max(first, address);
      const end = Math.min(first + count, address + size);
      if (begin < end) {
        fs.writeSync(descriptor, memory.content, begin, end - begin, begin - address);
      }
    },
  });
}

const COMMANDS = {
  // new IMAGE.bin TRANSMIT RECEIVE DRIVER-ENABLE SDA: creates a board with this image and these pins. DRIVER-ENABLE is
  // "none" if the transceiver switches its direction automatically. SCL is the pin after SDA. The supply of the board
  // is off, and its EEPROM is erased.
  new(path, ...pins) {
    const [transmit, receive, driverEnable, data] = pins.map((pin) => (pin === "none" ? null : integer(pin)));
    board = new Board(fs.readFileSync(path), { transmit, receive, driverEnable, data });
  },
  now: () => Math.round(board.time.now),
  // run NANOSECONDS: lets this time pass
  run(nanoseconds) {
    const until = board.time.now + integer(nanoseconds);
    while (board.time.now < until) {
      board.runUntil(until);
    }
  },
  power: (on) => board.power(on === "on"),
  reset: () => board.reset(),
  // reset-processor: resets only the processor, as a debug probe does
  "reset-processor": () => board.resetProcessor(),
  // power-after-copy: switches the supply on. The chip starts in the state that it has after an image has been copied
  // to the drive RPI-RP2.
  "power-after-copy": () => board.startAfterCopy(),
  echo(on) {
    board.echoes = on === "on";
  },
  baud: (rate) => board.setBaud(integer(rate)),
  // format 8N1|8N2|8E1|8O1: sets the line format of the master, which is 8N1 on a new board
  format: (name) => board.setFormat(name),
  // send HEX: sends bytes from the master, and returns when the last stop bit has ended
  send(hex) {
    board.send(bytesOf(hex));
    while (board.master.busy) {
      board.runUntil(Infinity);
    }
  },
  // await-release NANOSECONDS: lets time pass until the module's driver is off, but at most NANOSECONDS. An automatic
  // driver counts as off when the last stop bit has ended.
  "await-release"(nanoseconds) {
    const until = board.time.now + integer(nanoseconds);
    while (board.speaks && board.time.now < until) {
      board.runUntil(Math.min(until, board.time.now + STEP));
    }
  },
  // queue HEX: begins to send bytes from the master, and returns immediately
  queue: (hex) => board.send(bytesOf(hex)),
  // receive COUNT PATIENCE: returns up to COUNT bytes that have arrived and that no earlier command has returned. First
  // lets time pass until there are COUNT such bytes, or until no byte has arrived for PATIENCE nanoseconds.
  receive(count, patience) {
    let had = board.heard.length;
    let until = board.time.now + integer(patience);
    while (board.heard.length < integer(count) && board.time.now < until) {
      board.runUntil(until);
      if (board.heard.length !== had) {
        had = board.heard.length;
        until = board.time.now + integer(patience);
      }
    }
    return hexOf(board.takeHeard(integer(count)).map(({ byte }) => byte));
  },
  heard: () => hexOf(board.takeHeard().map(({ byte }) => byte)),
  // arrivals: returns the bytes that have arrived and that no earlier command has returned, as BYTE@TIME. BYTE is
  // decimal. TIME is the middle of the first stop bit, in nanoseconds.
  arrivals: () => board.takeHeard().map(({ byte, at }) => `${byte}@${Math.round(at)}`).join(" "),
  // pin NUMBER high|low|open: drives a pin from outside the chip, or stops driving it
  pin: (number, level) => board.setOutside(integer(number), level === "open" ? null : level === "high"),
  // pulses NUMBER COUNT NANOSECONDS: makes COUNT pulses on a pin. Each pulse has two edges: the first edge inverts the
  // level of the pin, and the second edge restores it. After each edge, NANOSECONDS pass.
  pulses(number, count, nanoseconds) {
    const pin = integer(number);
    const period = integer(nanoseconds);
    for (let edge = 0; edge < 2 * integer(count); edge += 1) {
      board.setOutside(pin, !board.levels[pin]);
      const until = board.time.now + period;
      while (board.time.now < until) {
        board.runUntil(until);
      }
    }
  },
  // train NUMBER COUNT NANOSECONDS: returns immediately. The same pulses as those of `pulses` begin after NANOSECONDS.
  train(number, count, nanoseconds) {
    const pin = integer(number);
    let left = 2 * integer(count);
    const alarm = board.time.createAlarm(() => {
      board.setOutside(pin, !board.levels[pin]);
      left -= 1;
      if (left > 0) {
        alarm.schedule(integer(nanoseconds));
      } else {
        board.time.alarms.delete(alarm);
      }
    });
    alarm.schedule(integer(nanoseconds));
  },
  levels: () => board.levels.reduce((mask, level, number) => mask + (level ? 2 ** number : 0), 0),
  // driven: returns the pins that the chip drives. Bit n is GPIOn.
  driven: () => board.levels.reduce(
    (mask, _, number) => mask + (board.chip.level(number) === null ? 0 : 2 ** number), 0),
  // watch NUMBER NANOSECONDS: lets time pass until the level of a pin changes, but at most NANOSECONDS. Returns 1 if
  // the level has changed, otherwise 0.
  watch(number, nanoseconds) {
    const pin = integer(number);
    const level = board.levels[pin];
    const until = board.time.now + integer(nanoseconds);
    board.watched = { number: pin, level };
    while (board.time.now < until && board.levels[pin] === level) {
      board.runUntil(until);
    }
    board.watched = null;
    return Number(board.levels[pin] !== level);
  },
  memory(hex) {
    board.eeprom.content.fill(0xff);
    board.eeprom.content.set(bytesOf(hex));
  },
  // absent: removes the EEPROM
  absent() {
    board.eeprom.present = false;
  },
  // flash ADDRESS SIZE: returns bytes of the flash chip
  flash: (address, size) => hexOf(board.flash.content.subarray(integer(address), integer(address) + integer(size))),
  // set-flash ADDRESS HEX: changes bytes of the flash chip
  "set-flash": (address, hex) => board.flash.content.set(bytesOf(hex), integer(address)),
  // stick ADDRESS: from now on, a program operation does not change this byte of the flash chip
  stick: (address) => board.flash.stuck.add(integer(address)) && "",
  // keep-flash DESCRIPTOR ADDRESS: copies an open file to the flash chip, from ADDRESS on. The function `keep` states
  // which later changes are written to the file.
  "keep-flash": (descriptor, address) => keep(board.flash, integer(descriptor), integer(address)),
  // keep-eeprom DESCRIPTOR: copies an open file to the EEPROM. The function `keep` states which later changes are
  // written to the file.
  "keep-eeprom": (descriptor) => keep(board.eeprom, integer(descriptor), 0),
  // flash-times ERASE PROGRAM: sets the durations of an erase and of a page program, in nanoseconds
  "flash-times"(erase, program) {
    board.flash.times = { erase: integer(erase), program: integer(program) };
  },
  // counts: returns how often each kind of event has occurred since `new`, and other values, as NAME=NUMBER
  counts: () => Object.entries({ ...board.counts, pages: board.eeprom.pagesProgrammed,
    erases: [...board.flash.erased.values()].reduce((sum, each) => sum + each, 0), reason: board.reason,
    depth: board.chip?.processor.deepest ?? 0, secondCoreOff: (board.chip?.psm.frceOff ?? 0) >> 16,
    secondCoreResets: board.chip?.secondCoreResets ?? 0,
    uart: board.chip?.uart.baud ?? 0, lineControl: board.chip?.uart.lineControl ?? 0 })
    .map(([name, value]) => `${name}=${value}`).join(" "),
  // pc: returns the address of the next instruction
  pc: () => board.chip.mcu.core.PC,
  // read ADDRESS: returns a word of RAM, in decimal
  read: (address) => board.chip.mcu.readUint32(integer(address)),
  // write ADDRESS HALFWORD: changes a halfword of RAM
  write: (address, value) => board.chip.mcu.writeUint16(integer(address), integer(value)),
  // lose INTERRUPT: the processor does not notice this interrupt until the next reset
  lose: (interrupt) => board.chip.processor.lose(integer(interrupt)),
};

function execute(line) {
  const [name, ...words] = line.split(" ");
  if (!Object.hasOwn(COMMANDS, name)) {
    throw new Error(`${name}: there is no such command; expected one of COMMANDS in emulator.js`);
  }
  return COMMANDS[name](...words) ?? "";
}

function answer(line) {
  try {
    return `ok ${execute(line)}\n`;
  } catch (error) {
    return `error ${error.message.replaceAll("\n", " ")}\n`;
  }
}

function main() {
  const buffer = Buffer.alloc(65536);
  let text = "";
  for (;;) {
    const size = fs.readSync(0, buffer, 0, buffer.length, null);
    if (size === 0) {
      return;
    }
    text += buffer.toString("latin1", 0, size);
    let end = text.indexOf("\n");
    while (end >= 0) {
      fs.writeSync(1, answer(text.slice(0, end)));
      text = text.slice(end + 1);
      end = text.indexOf("\n");
    }
  }
}

main();
