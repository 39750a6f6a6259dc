// A line with the face plates of its modules. The user can fold the line and search for modules.

import {hexByte, make} from "/element.js";

/// The largest number of modules for which the page opens lines by itself, because a browser needs seconds to create
/// thousands of plates.
export const mostUnfolded = 64;

export class LineView {
  /// `modules`: {position, model} of each module. `count` is the size class of the plates. `newsOf(position)` returns
  /// the state of a module, and `plateOf(position)` returns its plate, which it creates at the first call.
  constructor(line, modules, count, open, newsOf, plateOf) {
    this.line = line;
    this.modules = modules;
    this.newsOf = newsOf;
    this.plateOf = plateOf;
    this.plates = make("div", {class: "plates", "data-count": count});
    const ports = make("span", {class: "quiet"}, line.ports.join(", "));
    const size = make("span", {class: "quiet"}, `${modules.length} modules`);
    this.element = make("details", {class: "line", ontoggle: () => this.fill()},
      make("summary", {}, make("h3", {class: "linename"}, line.name, " ", ports), " ", size), this.plates);
    this.found = modules;
    this.unfold(open);
  }

  unfold(open) {
    this.element.open = open;
    this.fill();
  }

  /// Creates the plates of an open line. The plates of a folded line do not exist until the line is opened.
  fill() {
    if (this.element.open) {
      this.plates.replaceChildren(...this.found.map(({position}) => this.plateOf(position).element));
    }
  }

  /// Returns the modules that match all of `words`, which must be in lower case. If the name of the line matches,
  /// returns all modules of the line.
  matches(words) {
    const its = this.line.name.toLowerCase();
    const contains = (text) => words.every((word) => text.includes(word));
    return contains(its) ? this.modules : this.modules.filter((module) => contains(`${its} ${this.textOf(module)}`));
  }

  textOf({position, model}) {
    const {plate, stored} = this.newsOf(position);
    const address = plate?.listening ? hexByte(plate.address) : "";
    return `${position + 1} ${model} ${address} ${stored?.settings.name ?? ""}`.toLowerCase();
  }

  /// Shows only `found`, and hides the line if nothing is found.
  show(found) {
    this.found = found;
    this.element.hidden = !found.length;
    this.fill();
  }
}
