// The traffic of the lines: stores and searches it, and shows it as a strip on a time scale and as a list of frames and
// notes. A pause stops the strip and the list, but not the traffic.

import {setAttribute, setText} from "/element.js";
import {FrameList} from "/frame_list.js";
import {Strip} from "/strip.js";

/// Beyond `trimmedFrom` entries, the oldest are removed until `mostKept` remain: one by one would be slower.
const mostKept = 1700;
const trimmedFrom = 2000;
/// The same for entries that wait during a pause; less, so that older entries remain in the list when these are added.
const mostWaiting = 1000;
const waitingTrimmedFrom = 1200;
/// The minimum time between two drawings of the list, in ms: a busy line would cause one at each repaint.
const slowest = 30;

/// The number of frames in `entries`, and of frames and notes. Entries that did not arrive all count as frames, because
/// it is not known how many are.
const framesIn = (entries) =>
  entries.reduce((count, entry) => count + (entry.frames ?? entry.missed ?? (entry.note ? 0 : 1)), 0);
const rowsIn = (entries) => entries.reduce((count, entry) => count + (entry.missed ?? 1), 0);
const rowsOfFrames = (entries) => entries.filter(({note, missed}) => !note && !missed).length;

/// By its time: entries may arrive late.
function insert(list, entry) {
  let at = list.length;
  while (at > 0 && list[at - 1].began > entry.began) {
    --at;
  }
  list.splice(at, 0, entry);
}

export class Timeline {
  constructor() {
    for (const id of ["pause", "search", "span", "tally", "rows", "filler", "lanes", "canvas"]) {
      this[id] = document.getElementById(id);
    }
    this.list = new FrameList(this.rows, this.filler);
    this.strip = new Strip(this.lanes, this.canvas, this.span, (entry) => this.matches(entry));
    this.pause.addEventListener("click", () => this.setPaused(!this.paused));
    this.search.addEventListener("input", () => this.applySearch());
    this.begin([], null, null);
  }

  /// With an empty list. `lines`: an array of {name}; the functions get a position in it. `who(line, station)`: the
  /// name of a sender; `who(line)`: of the line. `now(line)`: its time in us.
  begin(lines, who, now) {
    this.who = who;
    this.entries = [];
    this.shown = [];
    this.pending = [];
    this.next = new Map();
    this.strip.begin(lines, now);
    this.list.clear();
    this.setPaused(false);
  }

  setPaused(paused) {
    this.paused = paused;
    setAttribute(this.pause, "aria-pressed", paused);
    setText(this.pause, paused ? "Resume" : "Pause");
    this.strip.setPaused(paused);
    this.list.paused = paused;
    if (!paused) {
      this.take(this.pending.splice(0));
    }
    this.stale = true;
  }

  /// `frames`: that of a message.
  add(frames) {
    const fresh = [];
    for (const {line, entries} of frames) {
      // After a lost connection, entries may arrive twice or be missing; also if they are too many for one message.
      const next = this.next.get(line) ?? entries[0].number;
      const missed = entries[0].number - next;
      if (missed > 0) {
        fresh.push(this.prepared({line, missed, began: entries[0].began}));
      }
      for (const entry of entries) {
        if (entry.number >= next) {
          fresh.push(this.prepared({...entry, line}));
        }
      }
      this.next.set(line, entries.at(-1).number + 1);
    }
    if (this.paused) {
      this.addWhilePaused(fresh);
    } else {
      this.take(fresh);
    }
  }

  /// If too many entries wait, replaces the oldest by one for each line, which states how many were left out.
  addWhilePaused(fresh) {
    this.pending.push(...fresh);
    if (this.pending.length > waitingTrimmedFrom) {
      const gone = this.pending.splice(0, this.pending.length - mostWaiting);
      const left = [...new Set(gone.map(({line}) => line))].map((line) => gone.filter((entry) => entry.line === line));
      this.pending.unshift(...left.map((entries) =>
        this.prepared({line: entries[0].line, missed: rowsIn(entries), frames: framesIn(entries),
          began: entries.at(-1).began})));
    }
    this.stale = true;
  }

  prepared(entry) {
    if (entry.note || entry.missed) {
      entry.from = this.who(entry.line);
      entry.said = "";
      entry.means = entry.note ?? `${entry.missed} ${entry.missed === 1 ? "row was" : "rows were"} left out here`;
    } else {
      const sign = entry.station === 0 ? "▶" : entry.station === null ? "?" : "◀";
      entry.from = `${sign} ${this.who(entry.line, entry.station)}`;
      const hex = entry.bytes.match(/../g)?.join(" ") ?? "";
      entry.said = entry.text ?? hex;
      entry.means = [entry.error, entry.error === entry.meaning ? null : entry.meaning].filter(Boolean).join("; ");
      entry.hex = hex;
    }
    entry.sought = `${entry.from} ${entry.said} ${entry.hex ?? ""} ${entry.bytes ?? ""} ${entry.means}`.toLowerCase();
    return entry;
  }

  matches(entry) { return !this.sought || entry.sought.includes(this.sought); }

  take(fresh) {
    for (const entry of fresh) {
      insert(this.entries, entry);
      if (this.matches(entry)) {
        insert(this.shown, entry);
      }
    }
    if (this.entries.length > trimmedFrom) {
      const gone = new Set(this.entries.splice(0, this.entries.length - mostKept));
      const before = this.shown.length;
      this.shown = this.shown.filter((entry) => !gone.has(entry));
      this.list.dropped(before - this.shown.length);
    }
    this.stale = true;
  }

  applySearch() {
    this.sought = this.search.value.trim().toLowerCase();
    this.shown = this.entries.filter((entry) => this.matches(entry));
    this.list.follows = true;
    this.stale = true;
  }

  tell() {
    const kept = rowsOfFrames(this.entries);
    const waiting = framesIn(this.pending) ? `, ${framesIn(this.pending)} more` : "";
    const of = this.sought ? `${rowsOfFrames(this.shown)} of ` : "";
    const frames = this.sought ? "" : kept === 1 ? " frame" : " frames";
    setText(this.tally, `${of}${kept}${frames}${waiting}`);
  }

  /// Once per repaint.
  draw(when) {
    if (this.stale) {
      this.strip.stale = true;
    }
    if ((this.stale || this.list.stale) && !(when - this.drawn < slowest)) {
      this.stale = false;
      this.drawn = when;
      this.list.draw(this.shown);
      this.tell();
    }
    this.strip.draw(when, this.entries);
  }
}
