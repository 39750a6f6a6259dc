// Writes a trace of a chip to a file, in the form that tests/bench/instruction_counts reads. The trace contains a line
// for each entry to an interrupt handler, for each return from a handler, and for each access to the data register of
// the UART. If requested, it also contains a line for each instruction.
"use strict";
const fs = require("fs");

const ENOUGH = 10_000; // when this many lines are in memory, `note` writes them to the file
const DATA = 0x00; // the data register of the UART

const hexOf = (word) => (word >>> 0).toString(16).padStart(8, "0");

class Trace {
  constructor(descriptor) {
    this.descriptor = descriptor;
    this.instructions = false; // whether the trace also contains each instruction
    this.executing = null; // address of the instruction that `executed` processes next, or null
    this.lines = [];
  }

  attach(chip) {
    const { core } = chip.mcu;
    const wrap = (object, name, wrapper) => {
      const inner = object[name].bind(object);
      Object.assign(object, { [name]: (...words) => wrapper(inner, ...words) });
    };
    wrap(core, "executeInstruction", (execute) => {
      this.executing = core.PC;
      const cycles = execute();
      this.executed();
      return cycles;
    });
    wrap(core, "exceptionEntry", (enter, exception) => {
      enter(exception);
      this.note(`nvic_acknowledge_irq IRQ: ${exception} now active`);
      // `execute` first enters a pending interrupt, and then executes the first instruction of the handler.
      this.executing = core.PC;
    });
    wrap(core, "exceptionReturn", (leave, code) => {
      const exception = core.IPSR;
      this.executed();
      leave(code);
      this.note(`nvic_complete_irq IRQ ${exception}`);
    });
    wrap(chip.uart, "readUint32", (read, offset) => {
      const value = read(offset);
      if (offset === DATA) {
        this.note(`pl011_read addr 0x${hexOf(offset)} value 0x${hexOf(value)}`);
      }
      return value;
    });
    wrap(chip.uart, "writeUint32", (write, offset, value) => {
      if (offset === DATA) {
        this.note(`pl011_write addr 0x${hexOf(offset)} value 0x${hexOf(value)}`);
      }
      write(offset, value);
    });
  }

  executed() {
    if (this.instructions && this.executing !== null) {
      this.note(`T/${hexOf(this.executing & ~1)}`);
    }
    this.executing = null;
  }

  note(line) {
    this.lines.push(line);
    if (this.lines.length >= ENOUGH) {
      this.flush();
    }
  }

  flush() {
    if (this.lines.length !== 0) {
      const bytes = Buffer.from(`${this.lines.join("\n")}\n`);
      this.lines = [];
      for (let sent = 0; sent < bytes.length;) {
        sent += fs.writeSync(this.descriptor, bytes, sent);
      }
    }
  }
}

module.exports = { Trace };
