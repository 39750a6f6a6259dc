// Corrects the interrupt mask of the I2C master of rp2040js, and the interrupt TX_EMPTY ("queue is low"). Also rejects
// accesses that a real chip does not permit in the present state of the master. Source: RP2040 data sheet, 4.3.
"use strict";

const CONTROL = 0x00;
const TARGET = 0x04;
const DATA_COMMAND = 0x10;
const HIGH_COUNT = 0x14;
const LOW_COUNT = 0x18;
const INTERRUPT_MASK = 0x30;
const RAW_INTERRUPTS = 0x34;
const CLEAR_ABORT = 0x54;
const HOLD_TIME = 0x7c;
const SPIKE_LENGTH = 0xa0;

const ABORTED = 1 << 6;
const QUEUE_LOW = 1 << 4;
const ON = 1 << 0;
const MASTER_ONLY = (1 << 0) | (1 << 6); // master enabled, slave disabled; the chip permits no other mode for a master

const WHILE_OFF = [CONTROL, TARGET, HIGH_COUNT, LOW_COUNT, HOLD_TIME, SPIKE_LENGTH];

function correctI2c(master) {
  const i2c = master;
  const read = i2c.readUint32.bind(i2c);
  const write = i2c.writeUint32.bind(i2c);
  let flushed = false; // after an abort, the queue discards commands until CLEAR_ABORT is read
  const raw = () => {
    const low = i2c.enable & ON && i2c.txFIFO.itemCount <= i2c.txThreshold;
    return (i2c.intRaw & ~QUEUE_LOW) | (low ? QUEUE_LOW : 0);
  };
  i2c.checkInterrupts = () => i2c.rp2040.setInterrupt(i2c.irq, (raw() & i2c.intEnable) !== 0);
  i2c.readUint32 = (offset) => {
    flushed = (flushed || (i2c.intRaw & ABORTED) !== 0) && offset !== CLEAR_ABORT;
    const value = offset === RAW_INTERRUPTS ? raw() : read(offset);
    i2c.checkInterrupts();
    return value;
  };
  i2c.writeUint32 = (offset, value) => {
    if (WHILE_OFF.includes(offset) && i2c.enable & ON) {
      i2c.error(`register 0x${offset.toString(16)} is written while the master is on`);
    }
    flushed = flushed || (i2c.intRaw & ABORTED) !== 0;
    if (offset === DATA_COMMAND && flushed) {
      i2c.error("a command is queued before the abort is cleared, and is discarded");
    }
    if (offset === DATA_COMMAND && (i2c.txFIFO.full || !(i2c.enable & ON))) {
      i2c.error("a command is queued while there is no room for it, or while the master is off");
    }
    if (offset === DATA_COMMAND && (read(CONTROL) & MASTER_ONLY) !== MASTER_ONLY) {
      i2c.error("the master is disabled or the slave is enabled; set the control bits 0 and 6");
    }
    if (offset === INTERRUPT_MASK) {
      i2c.intEnable = value;
    } else if (offset !== HOLD_TIME) {
      write(offset, value);
    }
    i2c.checkInterrupts();
  };
}

module.exports = { correctI2c };
