// A line with the face plates of its modules. The user can fold the line and search for modules.

import {hexByte, make} from "/element.js";

/// With more modules, the page opens no lines by itself: a browser needs seconds to create thousands of plates.
export const mostUnfolded = 64;

export class LineView {
  /// `modules`: {position, model} of each. `count`: the size of the plates: one, some or many. `open`: at first.
  /// `states`: of the modules, by position. `plateOf(position)` creates the plate at its first call.
  constructor(line, modules, count, open, states, plateOf) {
    this.line = line;
    this.modules = modules;
    this.states = states;
    this.plateOf = plateOf;
    this.plates = make("div", {class: "plates", "data-count": count});
    const ports = make("span", {class: "quiet"}, line.ports.join(", "));
    const size = make("span", {class: "quiet"}, `${modules.length} ${modules.length === 1 ? "module" : "modules"}`);
    this.element = make("details", {class: "line", ontoggle: () => this.fill()},
      make("summary", {}, make("h3", {class: "linename"}, line.name, " ", ports), " ", size), this.plates);
    this.show(modules, open);
  }

  /// If the line is open. A plate is created when it is shown for the first time.
  fill() {
    if (this.element.open) {
      this.plates.replaceChildren(...this.found.map(({position}) => this.plateOf(position).element));
    }
  }

  /// The modules that match all of `words`, in lower case. A word may be part of the line's name, or of a module's
  /// number, model, address, serial number or name.
  matches(words) {
    const its = this.line.name.toLowerCase();
    const contains = (text) => words.every((word) => text.includes(word));
    return contains(its) ? this.modules : this.modules.filter((module) => contains(`${its} ${this.textOf(module)}`));
  }

  textOf({position, model}) {
    const {plate, stored} = this.states[position];
    const known = plate?.listening ? `${hexByte(plate.address)} ${plate.serialNumber}` : "";
    return `${position + 1} ${model} ${known} ${stored?.settings.name ?? ""}`.toLowerCase();
  }

  /// Shows only the plates of `found`, and hides the line if that is empty.
  show(found, open) {
    this.found = found;
    this.element.hidden = !found.length;
    this.element.open = open;
    this.fill();
  }
}
