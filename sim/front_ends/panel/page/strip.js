// The strip: the frames and notes of each line on a time scale.

import {setAttribute} from "/element.js";

/// The minimum time between two drawings, in ms; the second value is for users who prefer reduced motion.
const slowest = 30;
const slowestUnmoving = 1000;
const unmoving = matchMedia("(prefers-reduced-motion: reduce)");

/// Heights in px.
const laneHeight = 52;
const scaleHeight = 20;

const inWords = (gap) => gap >= 1e6 ? `${(gap / 1e6).toFixed(2)} s` : `${(gap / 1000).toFixed(1)} ms`;

export class Strip {
  /// `frame`: around `canvas`; scrolls if it is too small for the lanes. `span`: an element, whose value is the visible
  /// time in us. Frames for which `matches(entry)` is false are pale.
  constructor(frame, canvas, span, matches) {
    this.frame = frame;
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
    this.span = span;
    this.matches = matches;
    this.lines = [];
    this.colours = {};
    this.span.addEventListener("change", () => { this.stale = true; });
    this.frame.addEventListener("scroll", () => { this.stale = true; }, {passive: true});
    new ResizeObserver(() => this.measure()).observe(this.canvas);
    const scheme = matchMedia("(prefers-color-scheme: dark)");
    scheme.addEventListener("change", () => { this.colours = {}; this.stale = true; });
    this.letMove();
    this.measure();
  }

  /// A lane for each of `lines`. `now(index)`: the time of the line in us.
  begin(lines, now) {
    this.lines = lines;
    this.now = now;
    this.canvas.style.blockSize = `${Math.max(1, lines.length) * laneHeight + scaleHeight}px`;
    this.frame.scrollTop = 0;
    this.stale = true;
  }

  setPaused(paused) {
    this.paused = paused;
    this.frozen = this.lines.map((line, index) => this.now(index));
    this.moved = 0;
    this.stale = true;
  }

  letMove() {
    const move = (pixels) => {
      this.moved = Math.max(0, this.moved + pixels * this.span.value / this.canvas.clientWidth);
      this.stale = true;
    };
    this.canvas.addEventListener("keydown", (event) => {
      const step = {ArrowLeft: 40, ArrowRight: -40, PageUp: 400, PageDown: -400}[event.key];
      if (step && this.paused) {
        event.preventDefault();
        move(step);
      }
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (this.paused && event.buttons & 1) {
        move(event.movementX);
      }
    });
  }

  measure() {
    const ratio = devicePixelRatio || 1;
    this.canvas.width = Math.round(this.canvas.clientWidth * ratio);
    this.canvas.height = Math.round(this.canvas.clientHeight * ratio);
    this.pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.stale = true;
  }

  colour(name) {
    this.colours[name] ??= getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
    return this.colours[name];
  }

  /// Once per repaint. Draws after a change, and repeatedly while the strip is not paused and contains entries.
  draw(when, entries) {
    const wait = unmoving.matches ? slowestUnmoving : slowest;
    if (this.lines.length && !(when - this.drawn < wait) && (this.stale || (!this.paused && !this.empty))) {
      this.stale = false;
      this.drawn = when;
      this.drawAll(entries);
    }
  }

  drawAll(entries) {
    const width = this.canvas.clientWidth;
    const span = Number(this.span.value);
    // Only the visible lanes are drawn, with the scale at the bottom.
    const top = this.frame.scrollTop;
    const bottom = Math.min(this.canvas.clientHeight, top + this.frame.clientHeight) - scaleHeight;
    this.pen.clearRect(0, 0, width, this.canvas.clientHeight);
    this.pen.font = "11px system-ui, sans-serif";
    this.drawGrid(width, top, bottom);
    const lanes = this.lines.map((line, index) => {
      const end = (this.paused ? this.frozen[index] : this.now(index)) - this.moved;
      return {line, top: index * laneHeight, start: end - span, end, before: null,
        x: (time) => (time - end + span) / span * width};
    });
    const seen = new Set(lanes.filter((lane) => lane.top + laneHeight > top && lane.top < bottom));
    seen.forEach((lane) => this.drawMiddle(lane, width));
    this.empty = true;
    for (let index = entries.length - 1; index >= 0; --index) {
      const entry = entries[index];
      const lane = lanes[entry.line];
      if ((entry.ended ?? entry.began) >= lane.start) {
        this.empty = false;
        if (seen.has(lane) && entry.began < lane.end) {
          this.drawEntry(entry, lane);
        }
      }
    }
    if (this.lines.length > 1) {
      seen.forEach((lane) => this.drawName(lane));
    }
    this.drawScale(width, bottom, span);
    const which = this.moved ? "An earlier period of" : "The last";
    setAttribute(this.canvas, "aria-label",
      `${which} ${span / 1000} ms on ${this.lines.length} line${this.lines.length > 1 ? "s" : ""}`);
  }

  tenths(width) { return width < 500 ? [0, 5, 10] : [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]; }

  drawGrid(width, top, bottom) {
    this.pen.strokeStyle = this.colour("edge");
    for (const tenth of this.tenths(width)) {
      this.pen.beginPath();
      this.pen.moveTo(width * tenth / 10, top);
      this.pen.lineTo(width * tenth / 10, bottom + 4);
      this.pen.stroke();
    }
  }

  drawScale(width, top, span) {
    this.pen.fillStyle = this.colour("plate");
    this.pen.fillRect(0, top + 4, width, scaleHeight - 4);
    this.pen.fillStyle = this.colour("quiet");
    for (const tenth of this.tenths(width)) {
      this.pen.textAlign = tenth === 0 ? "left" : tenth === 10 ? "right" : "center";
      this.pen.fillText(`${-(10 - tenth) * span / 1e4} ms`.replace("-", "−"), width * tenth / 10,
        top + scaleHeight - 4);
    }
  }

  drawMiddle({top}, width) {
    this.pen.strokeStyle = this.colour("quiet");
    this.pen.beginPath();
    this.pen.moveTo(0, top + laneHeight / 2);
    this.pen.lineTo(width, top + laneHeight / 2);
    this.pen.stroke();
  }

  drawName({line, top}) {
    this.pen.fillStyle = this.colour("ink");
    this.pen.textAlign = "left";
    this.pen.fillText(line.name, 4, top + 12);
  }

  /// From the last entry of a lane to the first: `lane.before` must be the frame that follows the entry.
  drawEntry(entry, lane) {
    if (entry.note || entry.missed) {
      this.pen.fillStyle = this.colour("note");
      this.pen.fillRect(lane.x(entry.began), lane.top + 2, 2, laneHeight - 4);
    } else {
      this.drawFrame(entry, lane.x(entry.began), lane.x(entry.ended), lane.top);
      this.drawGap(entry, lane.before, lane);
      lane.before = entry;
    }
  }

  drawFrame(entry, left, right, top) {
    const {pen} = this;
    const half = laneHeight / 2;
    const up = entry.station === 0;
    pen.globalAlpha = this.matches(entry) ? 1 : 0.25;
    pen.fillStyle = this.colour(entry.error ? "bad" : up ? "master" : "module");
    pen.fillRect(left, up ? top + half - 20 : top + half, Math.max(1.5, right - left), 20);
    if (right - left > 30) {
      pen.save();
      pen.beginPath();
      pen.rect(left, top, right - left - 3, laneHeight);
      pen.clip();
      pen.fillStyle = this.colour(entry.error ? "bad-ink" : "bar-ink");
      pen.textAlign = "left";
      pen.fillText(entry.said, left + 4, top + half + (up ? -6 : 14));
      pen.restore();
    }
    pen.globalAlpha = 1;
  }

  /// The length of the gap before the next frame, if there is room.
  drawGap(entry, next, {x, top}) {
    const gap = next ? next.began - entry.ended : 0;
    if (gap > 0 && x(next.began) - x(entry.ended) > 48) {
      this.pen.fillStyle = this.colour("quiet");
      this.pen.textAlign = "center";
      this.pen.fillText(inWords(gap), (x(entry.ended) + x(next.began)) / 2, top + laneHeight / 2 - 4);
    }
  }
}
