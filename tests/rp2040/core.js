// Corrects the processor of rp2040js: sleep, pending interrupts and faults. Source: ARMv6-M Architecture Reference
// Manual, B1.5 (exceptions, WFI) and B3.4 (NVIC).
"use strict";

const FIRST_INTERRUPT = 16;
const HARD_FAULT = 3;

// - When an interrupt line becomes asserted, its interrupt becomes pending. The interrupt stays pending until the
//   processor enters the handler, or until software clears it. If the line is asserted when the handler returns, the
//   interrupt becomes pending again.
// - A pending interrupt that is enabled in the NVIC wakes a sleeping processor, even if the interrupt became pending
//   before the sleep, and even if PRIMASK is set. If PRIMASK is set, the processor does not enter the handler.
// - A pending SysTick wakes the processor too.
// - The instructions UDF and BKPT enter the HardFault handler. In that handler, they stop the processor (lock-up). If
//   rp2040js detects another fault, for example an access to an invalid address, it reports an error instead.
class Processor {
  constructor(chip) {
    const { core } = chip;
    this.chip = chip;
    this.core = core;
    this.lines = 0;
    this.faulted = false;
    this.lockedUp = false;
    this.deepest = 0;
    this.lost = 0;  // interrupts that do not reach the processor
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

  // Sets the registers of the processor and of the NVIC to their values after a reset. Asserted interrupt lines stay
  // asserted, so their interrupts are pending after the reset.
  reset() {
    const { core } = this;
    Object.assign(core, { PM: false, IPSR: 0, SPSEL: 0, nPRIV: false, currentMode: 0, waiting: false, VTOR: 0,
      interruptNMIMask: 0, pendingInterrupts: this.lines, enabledInterrupts: 0,
      interruptPriorities: [0xffffffff, 0, 0, 0], pendingNMI: false, pendingPendSV: false,
      pendingSVCall: false, pendingSystick: false, SHPR2: 0, SHPR3: 0,
      interruptsUpdated: true });
    Object.assign(this, { faulted: false, lockedUp: false, depth: 0 });
  }

  fault() {
    this.faulted = true;
  }

  lose(irq) {
    this.lost |= 1 << irq;
  }

  setLine(irq, asserted) {
    const bit = 1 << irq;
    if (!asserted) {
      this.lines &= ~bit;
    } else if ((this.lines & bit) === 0 && (this.lost & bit) === 0) {
      this.lines |= bit;
      this.core.pendingInterrupts |= bit;
      this.core.interruptsUpdated = true;
    }
  }

  get wakes() {
    const { core } = this;
    return (core.pendingInterrupts & core.enabledInterrupts) !== 0 || core.pendingSystick;
  }

  // Executes an instruction, unless the processor sleeps or is locked up. Returns the cycles of the instruction.
  // Returns 0 if nothing changes until the next alarm, because the processor sleeps, is locked up, or has branched to
  // the same instruction.
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
