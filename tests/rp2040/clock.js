// Virtual time, in nanoseconds. It continues while the supply is off. The clock of a chip begins at 0 at power-on and
// at each reset of the chip. A reset of only the processor does not change the clock.
"use strict";

class Alarm {
  constructor(owner, callback) {
    this.owner = owner;
    this.callback = callback;
    this.at = Infinity;
  }

  schedule(nanoseconds) {
    this.scheduleAt(this.owner.time.now + nanoseconds);
  }

  scheduleAt(at) {
    this.at = at;
    this.owner.time.findNext();
  }

  cancel() {
    this.at = Infinity;
    this.owner.time.findNext();
  }

  get scheduled() {
    return this.at !== Infinity;
  }
}

class Time {
  constructor() {
    this.time = this; // an alarm uses `owner.time`, and its owner may be this Time
    this.now = 0; // nanoseconds
    this.next = Infinity; // time of the next alarm; Infinity: no alarm is scheduled
    this.alarms = new Set();
  }

  createAlarm(callback, owner = this) {
    const alarm = new Alarm(owner, callback);
    this.alarms.add(alarm);
    return alarm;
  }

  findNext() {
    let next = Infinity;
    for (const alarm of this.alarms) {
      if (alarm.at < next) {
        next = alarm.at;
      }
    }
    this.next = next;
  }

  advanceTo(to) {
    while (this.next <= to) {
      let first = null;
      for (const alarm of this.alarms) {
        if (first === null || alarm.at < first.at) {
          first = alarm;
        }
      }
      this.now = Math.max(this.now, first.at);
      first.cancel();
      first.callback();
    }
    this.now = to;
  }

  drop(owner) {
    for (const alarm of this.alarms) {
      if (alarm.owner === owner) {
        this.alarms.delete(alarm);
      }
    }
    this.findNext();
  }
}

// The clock of one chip, with the interface that rp2040js requires. `end` removes the alarms of this clock.
class ChipClock {
  constructor(time) {
    this.time = time;
    this.began = time.now;
  }

  get nanos() {
    return this.time.now - this.began;
  }

  get micros() {
    return this.nanos / 1000;
  }

  createAlarm(callback) {
    return this.time.createAlarm(callback, this);
  }

  end() {
    this.time.drop(this);
  }
}

module.exports = { Time, ChipClock };
