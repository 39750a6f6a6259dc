// The list of frames and notes. Only the visible entries and some around them have a row: there may be many more.

import {make, setAttribute, setText} from "/element.js";

const spareRows = 8;

const seconds = (microseconds) => (microseconds / 1e6).toFixed(6);

export class FrameList {
  /// `rows` scrolls. `filler` is an element inside it, as high as all entries together.
  constructor(rows, filler) {
    this.rows = rows;
    this.filler = filler;
    this.entries = [];
    this.made = new Map();
    this.follows = true;
    this.rows.addEventListener("scroll", () => {
      this.follows = this.rows.scrollTop + this.rows.clientHeight >= this.rows.scrollHeight - 4;
      this.draw(this.entries);
    }, {passive: true});
    new ResizeObserver(() => this.measure()).observe(this.rows);
    this.measure();
  }

  clear() {
    this.follows = true;
    this.made.clear();
    this.filler.replaceChildren();
    this.stale = true;
  }

  measure() {
    this.height = parseFloat(getComputedStyle(this.rows).getPropertyValue("--row")) || 24;
    this.stale = true;
  }

  /// After `count` entries at the top were removed: the visible ones stay, unless the list follows the newest entry.
  dropped(count) {
    if (!this.follows && count) {
      this.rows.scrollTop -= count * this.height;
    }
  }

  draw(entries) {
    this.entries = entries;
    this.stale = false;
    this.filler.style.blockSize = `${entries.length * this.height}px`;
    if (this.follows && !this.paused) {
      this.rows.scrollTop = this.rows.scrollHeight;
    }
    const top = this.rows.scrollTop;
    const first = Math.max(0, Math.floor(top / this.height) - spareRows);
    const last = Math.min(entries.length, Math.ceil((top + this.rows.clientHeight) / this.height) + spareRows);
    const seen = new Set(entries.slice(first, last));
    const spare = [];
    for (const [entry, row] of this.made) {
      if (!seen.has(entry)) {
        spare.push(row);
        this.made.delete(entry);
      }
    }
    for (let index = first; index < last; ++index) {
      const entry = entries[index];
      let row = this.made.get(entry);
      if (!row) {
        row = spare.pop() ?? this.makeRow();
        this.fillRow(row, entry);
        this.made.set(entry, row);
      }
      row.style.transform = `translateY(${index * this.height}px)`;
      this.place(row, index - first);
      setAttribute(row, "aria-rowindex", index + 2);
    }
    for (const row of spare) {
      row.remove();
    }
    setAttribute(this.rows, "aria-rowcount", entries.length + 1);
  }

  makeRow() {
    const row = make("div", {class: "row", role: "row"},
      ...["time", "from", "bytes", "meaning"].map((each) => make("span", {role: "cell", class: each})));
    this.filler.append(row);
    return row;
  }

  /// In the document, because screen readers and searches follow its order, not the order on the screen.
  place(row, position) {
    const there = this.filler.children[position];
    if (there !== row) {
      this.filler.insertBefore(row, there ?? null);
    }
  }

  fillRow(row, entry) {
    setAttribute(row, "data-kind", entry.error ? "error" : entry.note ? "note" : entry.missed ? "missed" : "frame");
    const texts = [entry.missed ? "…" : seconds(entry.began), entry.from, entry.said, entry.means];
    texts.forEach((text, column) => setText(row.children[column], text));
  }
}
