// Switches for the faults of a line.

import {make, setAttribute, setText} from "/element.js";
import {Switch} from "/switch.js";

export class Faults {
  /// `several`: there are several lines. `unfolded`: their lists are open at first. `usual`: the faults in the list at
  /// first. `modules`: {position, model} of each. `tell(command)` resolves to {ok, text}.
  constructor(line, {several, unfolded, usual}, modules, tell) {
    this.prefix = several ? `line ${line.name} ` : "";
    this.tell = tell;
    this.known = new Map();
    this.turned = Promise.resolve();
    this.list = make("ul", {class: "faultlist"});
    this.said = make("p", {class: "said", role: "status"});
    for (const text of usual) {
      this.learn(text, null);
    }
    const attributes = {class: "faultline", "aria-label": `Faults of ${line.name || "the line"}`};
    const content = [this.list, this.form(modules), this.said];
    this.element = several
      ? make("details", {...attributes, open: unfolded}, make("summary", {}, make("h3", {}, line.name)), ...content)
      : make("section", attributes, ...content);
  }

  form(modules) {
    const text = make("input", {type: "text", placeholder: "late-reply 50ms every 5th reply", autocomplete: "off",
      spellcheck: "false", size: "30", "aria-label": "Another fault"});
    const whose = make("select", {"aria-label": "Target of the fault"},
      make("option", {value: ""}, "the line and all its modules"),
      ...modules.map(({position, model}) => make("option", {value: position}, `${position + 1} ${model}`)));
    return make("form", {class: "bar", onsubmit: async (event) => {
      event.preventDefault();
      const wanted = text.value.trim();
      const module = whose.value === "" ? null : Number(whose.value);
      if (wanted && await this.turn(wanted, module, true)) {
        text.value = "";
      }
    }}, text, whose, make("button", {type: "submit"}, "Add"));
  }

  /// Returns the entry of the fault, which stays after the fault has ended, so that the user can switch it on again.
  learn(text, module) {
    const shown = module === null ? text : `module ${module + 1}: ${text}`;
    if (!this.known.has(shown)) {
      const knob = Switch.withKnob(`Fault ${shown}`, "slide", (on) => this.turn(text, module, on));
      const count = make("span", {class: "quiet"});
      const item = make("li", {}, knob.element, make("span", {"aria-hidden": "true"}, shown), count);
      this.known.set(shown, {knob, count, item, numbers: []});
      this.list.append(item);
    }
    return this.known.get(shown);
  }

  /// One after the other, because a fault has no number until it has been switched on.
  turn(text, module, on) {
    this.turned = this.turned.then(() => on ? this.begin(text, module) : this.end(this.learn(text, module).numbers));
    return this.turned;
  }

  async begin(text, module) {
    return this.say(await this.tell(module === null ? `${this.prefix}fault ${text}` : `${module + 1} fault ${text}`));
  }

  async end(numbers) {
    let ended = true;
    for (const number of numbers) {
      ended = this.say(await this.tell(`${this.prefix}fault off ${number}`)) && ended;
    }
    return ended;
  }

  say(reply) {
    setText(this.said, reply.ok ? "" : reply.text);
    return reply.ok;
  }

  show(faults) {
    const entries = faults.map(({text, module}) => this.learn(text, module));
    for (const entry of this.known.values()) {
      const these = faults.filter((fault, index) => entries[index] === entry);
      entry.numbers = these.map((fault) => fault.number);
      entry.knob.show(these.length > 0);
      setAttribute(entry.item, "data-in-progress", these.some((fault) => fault.inProgress));
      const occurrences = these.reduce((sum, fault) => sum + fault.soFar, 0);
      setText(entry.count, these.length ? `occurred ${occurrences}×` : "");
    }
  }
}
