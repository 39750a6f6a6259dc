// What is on or off, as people and screen readers are told.

import {make, setAttribute} from "/element.js";

export class Switch {
  /// `ask(on)` has it carried out, and resolves when what came of it is shown.
  constructor(name, className, ask, ...children) {
    this.ask = ask;
    this.asked = 0;
    this.element = make("button", {type: "button", role: "switch", class: className, "aria-checked": "false",
      "aria-label": name}, ...children);
  }

  /// With a knob to see, that a click moves.
  static withKnob(name, className, ask) {
    const knob = new Switch(name, className, ask, make("span", {class: "knob", "aria-hidden": "true"}));
    knob.element.addEventListener("click", () => knob.set(!knob.on));
    return knob;
  }

  /// As shown, or as asked for since: two clicks count as two, however soon.
  get on() { return this.asked ? this.wanted : this.element.getAttribute("aria-checked") === "true"; }

  async set(on) {
    this.wanted = on;
    ++this.asked;
    await this.ask(on);
    --this.asked;
  }

  show(on) { setAttribute(this.element, "aria-checked", on); }
}
