// A switch that is on or off, with the attributes that screen readers need.

import {make, setAttribute} from "/element.js";

export class Switch {
  /// `ask(on)` resolves when the page has shown the change, or when the request has failed.
  constructor(name, className, ask, ...children) {
    this.ask = ask;
    this.asked = 0;
    this.element = make("button", {type: "button", role: "switch", class: className, "aria-checked": "false",
      "aria-label": name}, ...children);
  }

  /// With a visible knob that a click moves.
  static withKnob(name, className, ask) {
    const knob = new Switch(name, className, ask, make("span", {class: "knob", "aria-hidden": "true"}));
    knob.element.addEventListener("click", () => knob.set(!knob.on));
    return knob;
  }

  /// The requested state while a request is in progress, so that two quick clicks switch twice; else the shown one.
  get on() { return this.asked ? this.wanted : this.element.getAttribute("aria-checked") === "true"; }

  async set(on) {
    this.wanted = on;
    ++this.asked;
    await this.ask(on);
    --this.asked;
  }

  show(on) { setAttribute(this.element, "aria-checked", on); }
}
