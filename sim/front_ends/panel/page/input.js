// An input of a module: its counter, its latches, and its LED, a button that switches, holds or pulses the input.

import {make, setAttribute, setText, terminal} from "/element.js";
import {Switch} from "/switch.js";

export class Input {
  /// `tell` and `way`: see the constructor of Plate; without `tell`, the input only shows its state.
  constructor(title, label, channel, tell, way) {
    this.label = label;
    this.channel = channel;
    this.tell = tell;
    this.way = way;
    /// The level to restore after a hold; null: not held.
    this.held = null;
    this.level = new Switch(`${title}: input ${label}`, "led input", (on) =>
      tell(this.command(on), this.held === null ? undefined : this.command(this.held)));
    this.count = make("span", {class: "count"}, "–");
    this.high = make("span", {class: "latch", role: "img"}, "H");
    this.low = make("span", {class: "latch", role: "img"}, "L");
    this.item = terminal(label, this.level.element,
      make("span", {class: "counter"}, make("span", {class: "hidden"}, `counter of ${label}: `), this.count),
      make("span", {class: "latches"}, this.high, this.low));
    if (tell) {
      this.listenToPointer(this.level.element);
      this.listenToKeys(this.level.element);
    } else {
      this.level.element.disabled = true;
    }
  }

  command(on) { return `input ${this.channel} ${on ? "on" : "off"}`; }

  /// Inverts the level until `release`, or until the page disconnects: then the simulator restores it.
  press() {
    if (this.held === null) {
      this.held = this.level.on;
      this.level.set(!this.held);
    }
  }

  release() {
    if (this.held !== null) {
      const level = this.held;
      this.held = null;
      this.level.set(level);
    }
  }

  /// When the connection is lost, because the simulator then releases a held input.
  lost() { this.held = null; }

  listenToPointer(button) {
    let heldByPointer = false;
    button.addEventListener("pointerdown", (event) => {
      heldByPointer = event.button === 0 && (this.way() === "hold" || event.shiftKey);
      if (heldByPointer) {
        button.setPointerCapture(event.pointerId);
        this.press();
      }
    });
    for (const over of ["pointerup", "pointercancel", "lostpointercapture", "blur"]) {
      button.addEventListener(over, () => this.release());
    }
    // A click without a pointer, as from a screen reader, has a `detail` of 0. It cannot hold, so it switches or
    // pulses.
    const isPointers = (event) => event.detail > 0;
    button.addEventListener("click", (event) => {
      if (isPointers(event) && heldByPointer) {
        heldByPointer = false;
      } else if (this.way() === "pulse" || event.altKey) {
        this.tell(`pulse ${this.channel}`);
      } else {
        this.level.set(!this.level.on);
      }
    });
    button.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  listenToKeys(button) {
    const isKey = (event) => event.key === " " || event.key === "Enter";
    button.addEventListener("keydown", (event) => {
      if (isKey(event) && (this.way() === "hold" || event.shiftKey || this.held !== null)) {
        event.preventDefault();
        if (!event.repeat) {
          this.press();
        }
      }
    });
    button.addEventListener("keyup", (event) => {
      if (isKey(event) && this.held !== null) {
        event.preventDefault();
        this.release();
      }
    });
  }

  show(on) { this.level.show(on); }

  showGathered(counter, high, low) {
    setText(this.count, String(counter));
    this.showLatch(this.high, "rising", high);
    this.showLatch(this.low, "falling", low);
  }

  showLatch(mark, edge, on) {
    const text = `${this.label}: ${edge} edge ${on ? "latched" : "not latched"}`;
    setAttribute(mark, "data-on", on);
    setAttribute(mark, "aria-label", text);
    setAttribute(mark, "title", text);
  }
}
