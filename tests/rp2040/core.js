// Corrects the processor of rp2040js: sleep, pending interrupts and faults. Source: ARMv6-M Architecture Reference
// Manual, B1.5 (exceptions, WFI) and B3.4 (NVIC).
"use strict";

const FIRST_INTERRUPT = 16;
const HARD_FAULT = 3;

// - An interrupt line that is asserted makes its interrupt pending, until the handler is entered. When the handler
//   returns and the line is still asserted, the interrupt becomes pending again.
// - An interrupt wakes a sleeping processor, even if it became pending before the sleep, and even if PRIMASK disables
//   it. If PRIMASK disables it, the handler is not entered.
// - SysTick wakes the processor too.
// - A fault enters the HardFault handler. A fault in that handler stops the processor.
class Processor {
  constructor(chip) {
    const { core } = chip;
    this.chip = chip;
    this.core = core;
    this.lines = 0;
    this.faulted = false;
    this.lockedUp = false;
    this.deepest = 0;
    core.setInterrupt = (irq, asserted) => this.setLine(irq, asserted);
    const enter = core.exceptionEntry.bind(core);
    core.exceptionEntry = (exception) => {
      if (exception >= FIRST_INTERRUPT) {
        core.pendingInterrupts &= ~(1 << (exception - FIRST_INTERRUPT));
      }
      this.depth = (this.depth ?? 0) + 1;
      this.deepest = Math.max(this.deepest, this.depth);
      enter(exception);
    };
    const leave = core.exceptionReturn.bind(core);
    core.exceptionReturn = (code) => {
      const bit = core.IPSR >= FIRST_INTERRUPT ? 1 << (core.IPSR - FIRST_INTERRUPT) : 0;
      this.depth -= 1;
      leave(code);
      core.pendingInterrupts |= this.lines & bit;
      core.interruptsUpdated = true;
    };
    Object.assign(chip, { onBreak: () => this.fault() });
  }

  fault() {
    this.faulted = true;
  }

  setLine(irq, asserted) {
    const bit = 1 << irq;
    if (!asserted) {
      this.lines &= ~bit;
    } else if ((this.lines & bit) === 0) {
      this.lines |= bit;
      this.core.pendingInterrupts |= bit;
      this.core.interruptsUpdated = true;
    }
  }

  get wakes() {
    const { core } = this;
    return (core.pendingInterrupts & core.enabledInterrupts) !== 0 || core.pendingSystick;
  }

  // Executes an instruction. Returns its cycles, or 0 if nothing changes until the next alarm: the processor sleeps, or
  // it has branched to the same instruction.
  step() {
    const { core } = this;
    if (core.waiting) {
      if (!this.wakes || this.lockedUp) {
        return 0;
      }
      core.waiting = false;
      core.interruptsUpdated = true;
    }
    const { PC } = core;
    const cycles = core.executeInstruction();
    if (this.faulted) {
      this.faulted = false;
      this.lockedUp = core.IPSR === HARD_FAULT;
      core.waiting = this.lockedUp;
      if (!this.lockedUp) {
        core.exceptionEntry(HARD_FAULT);
      }
    }
    return core.PC === PC && !core.interruptsUpdated ? 0 : cycles;
  }
}

module.exports = { Processor };
