// The values of a module: the present, power-on and safe value of each output, the settings, and the bytes of all
// stored copies. The elements are created once and only updated, to keep the scroll position and the selected text.

import {bit, hexByte, make, setAttribute, setText} from "/element.js";

/// [name, textOf] of each row, with `textOf(settings, plate, hostWatchdog)`. `inputs`: the label of each input.
function settingRows(inputs) {
  const listed = (labels) => labels.filter(Boolean).join(", ") || "none";
  const rowsOfInputs = [
    ["Counts", ({edge}) => `${edge} edges`],
    ["Input filters", ({filters}) =>
      listed(inputs.map((label, channel) => filters[channel] && `${label} ${filters[channel]} ms`))],
    ["Inverted inputs", ({inverted}) => listed(inputs.filter((label, channel) => bit(inverted, channel)))],
  ];
  return [
    ["Name", ({name}) => name],
    ["Address", ({address}) => hexByte(address)],
    ["Baud", ({baud}) => String(baud)],
    ["Line format", ({format}) => format],
    ["Protocol", ({protocol}) => protocol === "modbus" ? "Modbus RTU" : "ASCII"],
    ["Checksum", ({checksum}) => checksum ? "on" : "off"],
    ...inputs.length ? rowsOfInputs : [],
    ["Response delay", ({responseDelay}) => `${responseDelay} ms`],
    ["Host watchdog", ({watchdog, timeout}) =>
      `${watchdog ? "enabled" : "disabled"}, ${(timeout / 10).toFixed(1)} s`],
    ["Host watchdog restarted by", ({fedByRequests}) => fedByRequests ? "host OK and requests" : "host OK"],
    ["Timeout status", ({timedOut}) => timedOut ? "set" : "clear"],
    ["Reset status", (settings, {listening}, hostWatchdog) =>
      listening && hostWatchdog?.resetStatus ? "reset since the last $AA5" : "–"],
    ["Module watchdog", (settings, {resets}) => `${resets} ${resets === 1 ? "reset" : "resets"}`],
  ];
}

export class Drawer {
  /// `state`: the parts of the module's state that have arrived. The settings of a real module are texts, and its
  /// copies are not known.
  constructor(layout, title, state) {
    this.simulated = layout.simulated;
    this.state = state;
    this.values = layout.outputs.length ? this.valueTable(layout.outputs, title) : null;
    this.kept = make("h4", {});
    this.copies = (layout.simulated ? [1, 2] : []).map(() => ({caption: make("h4", {}), bytes: make("code", {})}));
    const rows = layout.simulated ? settingRows(layout.inputs) : [];
    this.settings = rows.map(([name, textOf]) => ({name, textOf, value: make("dd", {})}));
    this.list = make("dl", {}, ...this.settings.flatMap(({name, value}) => [make("dt", {}, name), value]));
    this.element = make("details", {class: "drawer", ontoggle: () => this.draw()},
      make("summary", {}, "Settings and values", make("span", {class: "hidden"}, ` of ${title}`)),
      make("div", {class: "drawerbody"}, ...(this.values ? [this.values.element] : []), this.kept,
        this.list,
        ...this.copies.map(({caption, bytes}) => make("div", {class: "copy"}, caption, bytes))));
  }

  /// Does nothing while the drawer is closed, or before the plate and the stored copies have arrived.
  draw() {
    const {plate, stored, hostWatchdog} = this.state;
    if (!this.element.open || !stored || !plate) {
      return;
    }
    const {settings} = stored;
    if (!this.simulated) {
      this.drawTexts(plate.outputs, settings);
      return;
    }
    this.values?.show(plate.outputs, settings.powerOn, settings.safe);
    setText(this.kept, originOfSettings(stored));
    for (const {textOf, value} of this.settings) {
      setText(value, textOf(settings, plate, hostWatchdog));
    }
    this.copies.forEach(({caption, bytes}, index) => {
      const copy = stored.copies[index];
      setText(caption, `Copy ${index + 1}: ${copyState(copy, index === stored.current)}`);
      setText(bytes, copy.bytes.match(/../g).join(" "));
    });
  }

  drawTexts(outputs, settings) {
    const ofHex = (text) => text && parseInt(text, 16);
    this.values?.show(outputs, ofHex(settings["power-on-value"]), ofHex(settings["safe-value"]));
    setText(this.kept, "Settings");
    const shown = JSON.stringify(settings);
    if (shown !== this.shown) {
      this.shown = shown;
      this.list.replaceChildren(...Object.entries(settings).flatMap(([name, text]) =>
        [make("dt", {}, name), make("dd", {}, text)]));
    }
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
      setText(cell, words[row] === undefined ? "" : on ? "1" : "0");
    }));
    return {element, show};
  }
}

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
