// Corrects the system PLL of rp2040js: the PLL requires power and a reference to lock, its control register and its
// multiplier cannot change while it runs, and it cannot clock the system before it has locked or while its post
// dividers have no power. Sources: RP2040 data sheet, 2.18 (PLL), 2.15.3.2 (glitchless multiplexers).
"use strict";

const CONTROL = 0x00;
const POWER = 0x04;
const LOCKED = 1 << 31;
const OFF = (1 << 0) | (1 << 5); // PD, VCOPD
const DIVIDERS_OFF = 1 << 3; // POSTDIVPD
const LOCKS = 50e3; // ns; the data sheet states no time
const SYSTEM_CONTROL = 0x3c;
const FROM_AUXILIARY = 1 << 0;
const AUXILIARY = 7 << 5; // the auxiliary source; 0: the system PLL

function correctPll(pll, crystal, clocks) {
  const { clock } = pll.rp2040;
  const inner = { read: pll.readUint32.bind(pll), write: pll.writeUint32.bind(pll),
    clocks: clocks.writeUint32.bind(clocks) };
  let lockedAt = Infinity;
  const isLocked = () => clock.nanos >= lockedAt;
  const start = () => {
    const oscillator = (pll.rp2040.xoscFreq / pll.refdiv) * pll.fbdiv;
    if (!crystal.stable) {
      pll.error("it starts without a reference");
    }
    if (oscillator < 750e6 || oscillator > 1600e6) {
      pll.error(`its oscillator starts with ${oscillator} Hz; expected 750 to 1600 MHz`);
    }
    lockedAt = clock.nanos + LOCKS;
  };
  Object.assign(pll, {
    readUint32(offset) {
      const value = inner.read(offset);
      return offset === CONTROL && !isLocked() ? value & ~LOCKED : value;
    },
    writeUint32(offset, value) {
      const wasOff = (inner.read(POWER) & OFF) !== 0;
      inner.write(offset, value);
      if (offset === POWER && value & OFF) {
        lockedAt = Infinity;
      } else if (offset === POWER && wasOff) {
        start();
      } else if (offset !== POWER && !wasOff && offset <= 0x08) {
        pll.error("it is set up while it runs");
      }
    },
  });
  const usesPll = (systemControl) => (systemControl & FROM_AUXILIARY) !== 0 && !(systemControl & AUXILIARY);
  // Sets the registers to their values after a reset of the block.
  Object.assign(pll, {
    reset() {
      if (usesPll(clocks.readUint32(SYSTEM_CONTROL))) {
        pll.error("it is reset while it is the system clock");
      }
      Object.assign(pll, { cs: 0x1, pwr: 0x2d, fbdivInt: 0, prim: 0x77000 });
      lockedAt = Infinity;
    },
  });
  Object.assign(clocks, {
    writeUint32(offset, value) {
      if (offset === SYSTEM_CONTROL && usesPll(value) && (!isLocked() || inner.read(POWER) & DIVIDERS_OFF)) {
        pll.error("it becomes the system clock before it runs");
      }
      inner.clocks(offset, value);
    },
  });
}

module.exports = { correctPll };
