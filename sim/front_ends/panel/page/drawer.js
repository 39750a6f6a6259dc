// The values of a module: the present, power-on and safe value of each output, the settings, and the bytes of all
// stored copies. The elements are created once and then only updated, so that the page keeps the scroll position and
// the selected text.

import {bit, hexByte, make, setAttribute, setText} from "/element.js";

export class Drawer {
  constructor(layout, title) {
    this.values = layout.outputs.length ? this.valueTable(layout.outputs, title) : null;
    this.kept = make("h4", {});
    this.settings = {};
    this.copies = [1, 2, 3, 4].map(() => ({state: make("h4", {}), bytes: make("code", {})}));
    const inputs = layout.inputs.length ? ["Counts", "Input filters", "Inverted inputs"] : [];
    this.inputs = layout.inputs;
    const names = ["Name", "Address", "Baud", "Line format", "Protocol", "Checksum", ...inputs, "Response delay",
      "Host watchdog", "Host watchdog restarted by", "Timeout status", "Reset status", "Module watchdog"];
    for (const name of names) {
      this.settings[name] = make("dd", {});
    }
    this.element = make("details", {class: "drawer"},
      make("summary", {}, "Settings and values", make("span", {class: "hidden"}, ` of ${title}`)),
      make("div", {class: "drawerbody"}, ...(this.values ? [this.values.element] : []), this.kept,
        make("dl", {}, ...names.flatMap((name) => [make("dt", {}, name), this.settings[name]])),
        ...this.copies.map(({state, bytes}) => make("div", {class: "copy"}, state, bytes))));
    this.element.addEventListener("toggle", () => this.draw());
  }

  /// Shows the state; parts that have not arrived yet are undefined.
  show(plate, stored, guard) {
    Object.assign(this, {plate, stored, guard});
    this.draw();
  }

  /// Does nothing while the drawer is closed, or before the plate and the stored copies have arrived.
  draw() {
    if (!this.element.open || !this.stored || !this.plate) {
      return;
    }
    const {plate, stored, guard} = this;
    const {settings} = stored;
    this.values?.show(plate.outputs, settings.powerOn, settings.safe);
    setText(this.kept, originOfSettings(stored));
    const texts = {
      "Name": settings.name,
      "Address": hexByte(settings.address),
      "Baud": String(settings.baud),
      "Line format": settings.format,
      "Protocol": settings.protocol === "modbus" ? "Modbus RTU" : "ASCII",
      "Checksum": settings.checksum ? "on" : "off",
      "Counts": `${settings.edge} edges`,
      "Input filters": this.ofInputs((channel) => settings.filters[channel], (time) => ` ${time} ms`),
      "Inverted inputs": this.ofInputs((channel) => bit(settings.inverted, channel), () => ""),
      "Response delay": `${settings.responseDelay} ms`,
      "Host watchdog": `${settings.watchdog ? "enabled" : "disabled"}, ${(settings.timeout / 10).toFixed(1)} s`,
      "Host watchdog restarted by": settings.fedByRequests ? "host OK and requests" : "host OK",
      "Timeout status": settings.timedOut ? "set" : "clear",
      "Reset status": plate.listening && guard?.resetStatus ? "reset since the last query" : "–",
      "Module watchdog": `${plate.resets} ${plate.resets === 1 ? "reset" : "resets"}`,
    };
    for (const [name, element] of Object.entries(this.settings)) {
      setText(element, texts[name]);
    }
    this.copies.forEach(({state, bytes}, index) => {
      const copy = stored.copies[index];
      state.parentElement.hidden = copy.old && copyState(copy) === "blank";
      const name = copy.old ? "Copy of earlier firmware" : `Copy ${index + 1}`;
      setText(state, `${name}: ${copyState(copy, index === stored.current)}`);
      setText(bytes, copy.bytes.match(/../g).join(" "));
    });
  }

  /// Returns the label of each input for which `read` returns a value that is not 0 or false, followed by the text of
  /// this value; "none" if there is no such input.
  ofInputs(read, textOf) {
    const labels = this.inputs.flatMap((label, channel) =>
      read(channel) ? [`${label}${textOf(read(channel))}`] : []);
    return labels.join(", ") || "none";
  }

  valueTable(outputs, title) {
    const rows = ["Present", "Power-on", "Safe"].map((name) => ({name, cells: outputs.map(() => make("td", {}))}));
    const names = outputs.map((label) => make("th", {scope: "col", title: label}, label.replace(/^[A-Z]+/, "")));
    const table = make("table", {class: "values"},
      make("thead", {}, make("tr", {}, make("td"), ...names)),
      make("tbody", {}, ...rows.map(({name, cells}) => make("tr", {}, make("th", {scope: "row"}, name), ...cells))));
    const attributes = {class: "wideable", tabindex: "0", role: "region", "aria-label": `${title}: output values`};
    const element = make("div", attributes, table);
    const show = (...words) => rows.forEach(({cells}, row) => cells.forEach((cell, channel) => {
      const on = bit(words[row], channel);
      setAttribute(cell, "data-on", on);
      setText(cell, on ? "1" : "0");
    }));
    return {element, show};
  }
}

/// Returns where the shown settings come from.
function originOfSettings(stored) {
  if (stored.current !== null) {
    return "Settings in EEPROM";
  }
  return stored.blank ? "EEPROM: blank, factory settings" : "EEPROM: no valid copy, factory settings";
}

function copyState(copy, inUse) {
  if (copy.sequence === null) {
    return /^F*$/.test(copy.bytes) ? "blank" : "not valid";
  }
  return `sequence ${copy.sequence}${inUse ? ", in use" : ""}`;
}
