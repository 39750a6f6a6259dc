// What is said on the lines: a strip to scale in time, and a list of frames.

import {make, setAttribute, setText} from "/element.js";

/// Older ones go, in pieces, since moving all of them for each would take longer: there are up to `trimmedFrom`.
const mostRows = 1700;
const trimmedFrom = 2000;
const spareRows = 8;
/// Between two times that it is drawn, in ms: a busy line would have every repaint taken up by it.
const slowest = 30;
/// Likewise the strip's, which moves by itself, for those whom that disturbs.
const unmoving = matchMedia("(prefers-reduced-motion: reduce)");
const slowestUnmoving = 1000;

const seconds = (microseconds) => (microseconds / 1e6).toFixed(6);

export class Timeline {
  constructor() {
    for (const id of ["pause", "search", "span", "tally", "strip", "rows", "head", "filler"]) {
      this[id] = document.getElementById(id);
    }
    this.shownRows = new Map();
    this.canvas = this.strip.getContext("2d");
    this.lines = [];
    this.clear();
    this.pause.addEventListener("click", () => this.setPaused(!this.paused));
    this.search.addEventListener("input", () => this.filterAnew());
    this.span.addEventListener("change", () => { this.stale = true; });
    this.rows.addEventListener("scroll", () => {
      this.follows = this.rows.scrollTop + this.rows.clientHeight >= this.rows.scrollHeight - 4;
      this.drawRows();
    }, {passive: true});
    new ResizeObserver(() => this.measure()).observe(this.rows);
    new ResizeObserver(() => this.measure()).observe(this.strip);
    this.letMove();
    const scheme = matchMedia("(prefers-color-scheme: dark)");
    scheme.addEventListener("change", () => { this.colours = null; this.stale = true; });
    this.measure();
  }

  clear() {
    this.entries = [];
    this.shown = [];
    this.pending = [];
    this.next = new Map();
    this.follows = true;
    this.moved = 0;
    this.stale = true;
    for (const row of this.shownRows.values()) {
      row.remove();
    }
    this.shownRows.clear();
  }

  /// `lines`: {name}; `who(line, station)` names a sender; `now(line)` is its time in us.
  begin(lines, who, now) {
    this.lines = lines;
    this.who = who;
    this.now = now;
    this.strip.style.blockSize = `${Math.min(lines.length, 6) * 52 + 20}px`;
    this.stale = true;
  }

  setPaused(paused) {
    this.paused = paused;
    setAttribute(this.pause, "aria-pressed", paused);
    setText(this.pause, paused ? "Go on" : "Pause");
    this.frozen = this.lines.map((line, index) => this.now(index));
    this.moved = 0;
    if (!paused) {
      const pending = this.pending;
      this.pending = [];
      this.take(pending);
    }
    this.stale = true;
  }

  /// `frames` as they come in a message.
  add(frames) {
    const fresh = [];
    for (const {line, entries} of frames) {
      // After a lost connection some may come again, and others never.
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
      this.next.set(line, entries[entries.length - 1].number + 1);
    }
    fresh.sort((a, b) => a.began - b.began);
    if (this.paused) {
      this.pending.push(...fresh);
      if (this.pending.length > trimmedFrom) {
        this.pending.splice(0, this.pending.length - mostRows);
      }
    } else {
      this.take(fresh);
    }
  }

  prepared(entry) {
    if (entry.missed) {
      entry.from = "";
      entry.said = "";
      entry.means = `${entry.missed} frames were left out here`;
    } else if (entry.note) {
      entry.from = "line";
      entry.said = "";
      entry.means = entry.note;
    } else {
      entry.from = `${entry.station === 0 ? "▶" : entry.station === null ? "?" : "◀"} ${this.who(entry.line, entry.station)}`;
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
    this.entries.push(...fresh);
    this.shown.push(...fresh.filter((entry) => this.matches(entry)));
    if (this.entries.length > trimmedFrom) {
      const gone = new Set(this.entries.splice(0, this.entries.length - mostRows));
      const before = this.shown.length;
      this.shown = this.shown.filter((entry) => !gone.has(entry));
      this.dropRows(before - this.shown.length);
    }
    this.stale = true;
    this.rowsStale = true;
  }

  /// Whoever reads further up goes on reading the same.
  dropRows(count) {
    if (!this.follows && count) {
      this.rows.scrollTop -= count * this.rowHeight;
    }
  }

  filterAnew() {
    this.sought = this.search.value.trim().toLowerCase();
    this.shown = this.entries.filter((entry) => this.matches(entry));
    this.follows = true;
    this.rowsStale = true;
    this.stale = true;
  }

  measure() {
    this.rowHeight = parseFloat(getComputedStyle(this.rows).getPropertyValue("--row")) || 24;
    const ratio = devicePixelRatio || 1;
    const {clientWidth, clientHeight} = this.strip;
    this.strip.width = Math.round(clientWidth * ratio);
    this.strip.height = Math.round(clientHeight * ratio);
    this.canvas.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.stale = true;
    this.rowsStale = true;
  }

  /// Once a repaint.
  draw(when) {
    if (this.rowsStale && !(when - this.rowsDrawn < slowest)) {
      this.rowsStale = false;
      this.rowsDrawn = when;
      this.drawRows();
      const waiting = this.pending.length ? `, ${this.pending.length} more` : "";
      setText(this.tally, this.sought ? `${this.shown.length} of ${this.entries.length}${waiting}`
        : `${this.entries.length} ${this.entries.length === 1 ? "frame" : "frames"}${waiting}`);
    }
    if (this.lines.length && !(when - this.stripDrawn < (unmoving.matches ? slowestUnmoving : slowest)) && (this.stale || (!this.paused && !this.empty))) {
      this.stale = false;
      this.stripDrawn = when;
      this.drawStrip();
    }
  }

  /// Those that can be seen, and a few around.
  drawRows() {
    const height = this.rowHeight;
    this.filler.style.blockSize = `${this.shown.length * height}px`;
    if (this.follows && !this.paused) {
      this.rows.scrollTop = this.rows.scrollHeight;
    }
    const top = this.rows.scrollTop;
    const first = Math.max(0, Math.floor(top / height) - spareRows);
    const last = Math.min(this.shown.length, Math.ceil((top + this.rows.clientHeight) / height) + spareRows);
    const seen = new Set(this.shown.slice(first, last));
    const spare = [];
    for (const [entry, row] of this.shownRows) {
      if (!seen.has(entry)) {
        spare.push(row);
        this.shownRows.delete(entry);
      }
    }
    for (let index = first; index < last; ++index) {
      const entry = this.shown[index];
      let row = this.shownRows.get(entry);
      if (!row) {
        row = spare.pop() ?? this.makeRow();
        this.fillRow(row, entry);
        this.shownRows.set(entry, row);
      }
      row.style.transform = `translateY(${index * height}px)`;
      setAttribute(row, "aria-rowindex", index + 2);
    }
    for (const row of spare) {
      row.remove();
    }
    setAttribute(this.rows, "aria-rowcount", this.shown.length + 1);
  }

  makeRow() {
    const row = make("div", {class: "row", role: "row"},
      ...["time", "from", "bytes", "meaning"].map((each) => make("span", {role: "cell", class: each})));
    this.filler.append(row);
    return row;
  }

  fillRow(row, entry) {
    setAttribute(row, "data-kind", entry.error ? "error" : entry.note ? "note" : entry.missed ? "missed" : "frame");
    const texts = [entry.missed ? "…" : seconds(entry.began), entry.from, entry.said, entry.means];
    texts.forEach((text, column) => setText(row.children[column], text));
  }

  // --- the strip ---

  letMove() {
    const move = (pixels) => {
      if (this.paused) {
        this.moved = Math.max(0, this.moved + pixels * this.span.value / this.strip.clientWidth);
        this.stale = true;
      }
    };
    this.strip.addEventListener("keydown", (event) => {
      const step = {ArrowLeft: 40, ArrowRight: -40, PageUp: 400, PageDown: -400}[event.key];
      if (step && this.paused) {
        event.preventDefault();
        move(step);
      }
    });
    this.strip.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) {
        move(event.movementX);
      }
    });
  }

  colour(name) {
    if (!this.colours) {
      const style = getComputedStyle(document.documentElement);
      this.colours = Object.fromEntries(["ink", "quiet", "edge", "master", "module", "bad", "note"].map((each) =>
        [each, style.getPropertyValue(`--${each}`).trim()]));
    }
    return this.colours[name];
  }

  drawStrip() {
    const {canvas} = this;
    const width = this.strip.clientWidth;
    const height = this.strip.clientHeight;
    const span = Number(this.span.value);
    canvas.clearRect(0, 0, width, height);
    canvas.font = "11px system-ui, sans-serif";
    this.empty = true;
    const lanes = Math.min(this.lines.length, 6);
    const lane = (height - 20) / lanes;
    this.drawScale(width, height, span);
    for (let line = 0; line < lanes; ++line) {
      const end = (this.paused ? this.frozen[line] : this.now(line)) - this.moved;
      this.drawLane(line, line * lane, lane, width, end - span, span);
    }
    setAttribute(this.strip, "aria-label", `The last ${span / 1000} ms of ${this.lines.length} line${this.lines.length > 1 ? "s" : ""}`);
  }

  drawScale(width, height, span) {
    const {canvas} = this;
    canvas.fillStyle = this.colour("quiet");
    canvas.strokeStyle = this.colour("edge");
    canvas.textAlign = "center";
    for (let tenth = 0; tenth <= 10; tenth += width < 500 ? 5 : 1) {
      const x = width * tenth / 10;
      canvas.beginPath();
      canvas.moveTo(x, 0);
      canvas.lineTo(x, height - 16);
      canvas.stroke();
      canvas.textAlign = tenth === 0 ? "left" : tenth === 10 ? "right" : "center";
      canvas.fillText(`${-(10 - tenth) * span / 1e4} ms`.replace("-0 ms", "0").replace("-", "−"), x, height - 4);
    }
  }

  drawLane(line, top, height, width, start, span) {
    const {canvas} = this;
    const middle = top + height / 2;
    const x = (time) => (time - start) / span * width;
    canvas.strokeStyle = this.colour("quiet");
    canvas.beginPath();
    canvas.moveTo(0, middle);
    canvas.lineTo(width, middle);
    canvas.stroke();
    let before = null;
    for (let index = this.entries.length - 1; index >= 0; --index) {
      const entry = this.entries[index];
      if (entry.line !== line) {
        continue;
      }
      if ((entry.ended ?? entry.began) < start) {
        break;
      }
      if (entry.note) {
        canvas.fillStyle = this.colour("note");
        canvas.fillRect(x(entry.began), top + 2, 2, height - 4);
      } else if (!entry.missed && entry.began < start + span) {
        this.drawFrame(entry, x(entry.began), x(entry.ended), top, height);
        this.drawGap(entry, before, x, middle);
        before = entry;
      }
    }
    if (this.lines.length > 1) {
      canvas.fillStyle = this.colour("ink");
      canvas.textAlign = "left";
      canvas.fillText(this.lines[line].name, 4, top + 12);
    }
  }

  drawFrame(entry, left, right, top, height) {
    const {canvas} = this;
    const half = height / 2;
    const up = entry.station === 0;
    canvas.globalAlpha = this.matches(entry) ? 1 : 0.25;
    canvas.fillStyle = this.colour(entry.error ? "bad" : up ? "master" : "module");
    canvas.fillRect(left, up ? top + half - 20 : top + half, Math.max(1.5, right - left), 20);
    const text = entry.said;
    this.empty = false;
    if (right - left > 30) {
      canvas.save();
      canvas.beginPath();
      canvas.rect(left, top, right - left - 3, height);
      canvas.clip();
      canvas.fillStyle = "#fff";
      canvas.textAlign = "left";
      canvas.fillText(text, left + 4, top + half + (up ? -6 : 14));
      canvas.restore();
    }
    canvas.globalAlpha = 1;
  }

  /// The silence up to the next frame, where there is room to say it.
  drawGap(entry, next, x, middle) {
    const room = next ? x(next.began) - x(entry.ended) : 0;
    const gap = next ? next.began - entry.ended : 0;
    if (room > 48 && gap > 0) {
      const {canvas} = this;
      canvas.fillStyle = this.colour("quiet");
      canvas.textAlign = "center";
      canvas.fillText(gap >= 1e6 ? `${(gap / 1e6).toFixed(2)} s` : `${(gap / 1000).toFixed(1)} ms`,
        x(entry.ended) + room / 2, middle - 4);
    }
  }
}
