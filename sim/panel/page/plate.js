// A module's face plate: its terminals, lamps and switches, and a drawer with what it keeps.

import {bit, hexByte, make, makeSwitch, setAttribute, setText} from "/element.js";

const edgeTerminals = ["INIT*", "DATA+", "DATA−", "+VS", "GND"];

export class Plate {
  /// `position` counts from 0; `tell(command)` carries out what follows the module's number; `way()` is what a
  /// click on an input does: toggle, hold or pulse.
  constructor(layout, position, tell, way) {
    this.layout = layout;
    this.position = position;
    this.tell = tell;
    this.title = `${position + 1} ${layout.model}`;
    this.way = way;
    this.outputs = layout.outputs.map((label) => this.makeOutput(label));
    this.inputs = layout.inputs.map((label, channel) => this.makeInput(label, channel));
    this.element = this.build();
  }

  build() {
    const name = (text) => `${this.title}: ${text}`;
    this.name = make("span", {class: "name"});
    this.led = make("span", {class: "led status", role: "img", "aria-label": "Status LED"});
    this.ledText = make("span", {class: "ledtext"});
    this.power = makeSwitch(name("power"), "rocker", (on) => this.tell(`power ${on ? "on" : "off"}`));
    this.init = makeSwitch(name("INIT* to GND"), "slide", (on) => this.tell(`init ${on ? "on" : "off"}`));
    this.reset = make("button", {type: "button", class: "reset", "aria-label": name("reset"),
      onclick: () => this.tell("reset")}, "Reset");
    this.address = this.readout("Address");
    this.baud = this.readout("Baud");
    this.protocol = this.readout("Protocol");
    this.guard = this.readout("Host watchdog", "wide");
    this.bar = make("span", {class: "countdown", "aria-hidden": "true"}, make("span"));
    this.guard.box.append(this.bar);
    this.drawer = make("div", {class: "drawerbody"});
    this.details = make("details", {class: "drawer"},
      make("summary", {}, "Settings and values", make("span", {class: "hidden"}, ` of ${this.title}`)),
      this.drawer);
    this.details.addEventListener("toggle", () => this.drawDrawer());
    const channels = [];
    const columns = (list) => String(list.length > 8 ? Math.ceil(list.length / 2) : Math.max(list.length, 4));
    if (this.outputs.length) {
      const list = make("ul", {class: "channels outputs", "aria-label": "Outputs"},
        ...this.outputs.map((output) => output.item));
      list.style.setProperty("--columns", columns(this.outputs));
      if (this.outputs.length > 8 && this.outputs.length % 2) {
        list.append(make("li", {"aria-hidden": "true"}));
      }
      channels.push(list);
    }
    if (this.inputs.length) {
      const list = make("ul", {class: "channels inputs", "aria-label": "Inputs"},
        ...this.inputs.map((input) => input.item));
      list.style.setProperty("--columns", columns(this.inputs));
      channels.push(list);
    }
    return make("article", {class: "plate", "aria-label": this.title},
      make("div", {class: "head"},
        make("div", {class: "title"}, make("h3", {}, this.layout.model), this.name),
        make("div", {class: "lamp"}, this.led, this.ledText)),
      make("div", {class: "readouts"}, this.address.box, this.baud.box, this.protocol.box, this.guard.box),
      ...channels,
      make("div", {class: "controls"},
        make("span", {class: "control"}, make("span", {"aria-hidden": "true"}, "Power"), this.power),
        make("span", {class: "control"}, make("span", {"aria-hidden": "true"}, "INIT*"), this.init),
        this.reset),
      this.details,
      make("ul", {class: "edge", "aria-hidden": "true"},
        ...edgeTerminals.map((label) => make("li", {}, make("span", {class: "screw"}), label))));
  }

  readout(label, extra = "") {
    const value = make("span", {class: "value"});
    return {value, box: make("span", {class: `readout ${extra}`}, make("span", {class: "label"}, label), value)};
  }

  makeOutput(label) {
    const led = make("span", {class: "led output", role: "img", "aria-label": `${label} off`});
    return {label, led, item: make("li", {}, make("span", {class: "screw", "aria-hidden": "true"}),
      make("span", {class: "label", "aria-hidden": "true"}, label), led)};
  }

  makeInput(label, channel) {
    const button = make("button", {type: "button", role: "switch", class: "led input", "aria-checked": "false",
      "aria-label": `${this.title}: input ${label}`});
    const counter = make("span", {class: "counter", "aria-label": `counter of ${label}`});
    const high = make("span", {class: "latch", role: "img"}, "H");
    const low = make("span", {class: "latch", role: "img"}, "L");
    this.makeTouchable(button, channel);
    return {label, button, counter, high, low, item: make("li", {}, make("span", {class: "screw", "aria-hidden": "true"}),
      make("span", {class: "label", "aria-hidden": "true"}, label), button, counter,
      make("span", {class: "latches"}, high, low))};
  }

  /// Held: the other level, for as long as button or key is down.
  makeTouchable(button, channel) {
    const level = () => button.getAttribute("aria-checked") === "true";
    const set = (on) => this.tell(`input ${channel} ${on ? "on" : "off"}`);
    let held = null;
    let wasHeld = false;
    const press = () => {
      if (held === null) {
        held = level();
        set(!held);
      }
    };
    const release = () => {
      if (held !== null) {
        set(held);
        held = null;
        wasHeld = true;
      }
    };
    button.addEventListener("pointerdown", (event) => {
      wasHeld = false;
      if (event.button === 0 && (this.way() === "hold" || event.shiftKey)) {
        button.setPointerCapture(event.pointerId);
        press();
      }
    });
    for (const over of ["pointerup", "pointercancel", "lostpointercapture", "blur"]) {
      button.addEventListener(over, release);
    }
    const isKey = (event) => event.key === " " || event.key === "Enter";
    button.addEventListener("keydown", (event) => {
      if (!isKey(event)) {
        return;
      }
      if (this.way() === "hold" || event.shiftKey || held !== null) {
        event.preventDefault();
        if (!event.repeat) {
          press();
        }
      } else if (!event.repeat) {
        wasHeld = false;
      }
    });
    button.addEventListener("keyup", (event) => {
      if (isKey(event) && held !== null) {
        event.preventDefault();
        release();
      }
    });
    button.addEventListener("click", (event) => {
      if (wasHeld || this.way() === "hold") {
        wasHeld = false;
      } else if (this.way() === "pulse" || event.altKey) {
        this.tell(`pulse ${channel}`);
      } else {
        set(!level());
      }
    });
    button.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  /// What has changed of it.
  show(news) {
    if (news.plate) {
      this.plate = news.plate;
      this.showPlate(news.plate);
    }
    if (news.gathered) {
      this.showGathered(news.gathered);
    }
    if (news.guard) {
      this.guardState = news.guard;
    }
    if (news.stored) {
      this.stored = news.stored;
      setText(this.name, news.stored.settings.name);
    }
    this.drawDrawer();
  }

  showPlate(plate) {
    setAttribute(this.element, "data-powered", plate.powered);
    setAttribute(this.power, "aria-checked", plate.switch);
    setAttribute(this.init, "aria-checked", plate.init);
    this.reset.disabled = !plate.powered;
    const flashing = plate.led.startsWith("flashing");
    setAttribute(this.led, "data-led", plate.led === "flashing" ? "flashing" : flashing ? "unreadable" : plate.led);
    setAttribute(this.led, "aria-label", `Status LED ${plate.led}`);
    const supply = plate.switch && !plate.powered ? "no supply" : plate.led;
    setText(this.ledText, plate.initMode ? `${supply}, INIT mode` : supply);
    const on = plate.listening;
    setText(this.address.value, on ? hexByte(plate.address) : "––");
    setText(this.baud.value, on ? String(plate.baud) : "––");
    setText(this.protocol.value, !on ? "––" : plate.protocol === "modbus" ? "RTU" : plate.checksum ? "ASCII+Σ" : "ASCII");
    this.outputs.forEach(({label, led}, channel) => {
      const lit = bit(plate.outputs, channel);
      setAttribute(led, "data-on", lit);
      setAttribute(led, "aria-label", `${label} ${lit ? "on" : "off"}`);
    });
    this.inputs.forEach(({button}, channel) => {
      setAttribute(button, "aria-checked", bit(plate.inputs, channel));
    });
  }

  showGathered(gathered) {
    const latch = (mark, text, on) => {
      setAttribute(mark, "data-on", on);
      setAttribute(mark, "aria-label", `${text} edge ${on ? "latched" : "not latched"}`);
      setAttribute(mark, "title", mark.getAttribute("aria-label"));
    };
    this.inputs.forEach(({label, counter, high, low}, channel) => {
      setText(counter, String(gathered.counters[channel]));
      latch(high, `${label}: rising`, bit(gathered.high, channel));
      latch(low, `${label}: falling`, bit(gathered.low, channel));
    });
  }

  /// `now`: what the line's clock shows, in us. What runs by itself.
  tick(now) {
    const guard = this.guardState;
    if (!guard) {
      return;
    }
    const total = guard.timeout * 1e5;
    const left = guard.expires === null ? 0 : Math.max(0, guard.expires - now);
    let text = "off";
    if (!this.plate?.listening) {
      text = "––";
    } else if (guard.timedOut) {
      text = "timed out";
    } else if (guard.enabled) {
      text = `${(left / 1e6).toFixed(1)} s of ${(total / 1e6).toFixed(1)} s`;
    }
    setText(this.guard.value, text);
    setAttribute(this.guard.box, "data-state", guard.timedOut ? "expired" : guard.enabled ? "runs" : "off");
    const share = guard.enabled && total ? Math.round(100 * left / total) : 0;
    if (share !== this.share) {
      this.share = share;
      this.bar.firstChild.style.inlineSize = `${share}%`;
    }
  }

  /// Only while it is open.
  drawDrawer() {
    if (!this.details.open || !this.stored || !this.plate) {
      return;
    }
    const {settings} = this.stored;
    const guard = this.guardState;
    const rows = [
      ["Name", settings.name],
      ["Address", hexByte(settings.address)],
      ["Baud", settings.baud],
      ["Protocol", settings.protocol === "modbus" ? "Modbus RTU" : "ASCII"],
      ["Checksum", settings.checksum ? "on" : "off"],
    ];
    if (this.inputs.length) {
      rows.push(["Counts", `${settings.edge} edges`]);
    }
    rows.push(["Host watchdog", `${settings.watchdog ? "enabled" : "disabled"}, ${(settings.timeout / 10).toFixed(1)} s`],
      ["Timeout status", settings.timedOut ? "set" : "clear"],
      ["Reset status", this.plate.listening && guard?.resetStatus ? "reset since last asked" : "–"],
      ["Module watchdog", `${this.plate.resets} resets`]);
    const list = make("dl", {}, ...rows.flatMap(([key, value]) => [make("dt", {}, key), make("dd", {}, String(value))]));
    this.drawer.replaceChildren(...this.outputs.length ? [this.valueTable(settings)] : [],
      make("h4", {}, this.stored.blank ? "EEPROM: blank, factory settings" : "Settings in EEPROM"), list,
      ...this.stored.copies.map((copy, index) => this.copyText(copy, index)));
  }

  valueTable(settings) {
    const row = (label, word) => make("tr", {}, make("th", {scope: "row"}, label),
      ...this.outputs.map((output, channel) => {
        const on = bit(word, channel);
        return make("td", {"data-on": String(on)}, on ? "1" : "0");
      }));
    return make("div", {class: "wideable", tabindex: "0", role: "region", "aria-label": `${this.title}: output values`},
      make("table", {class: "values"},
        make("thead", {}, make("tr", {}, make("td"), ...this.outputs.map(({label}) =>
          make("th", {scope: "col", title: label}, label.replace(/^[A-Z]+/, ""))))),
        make("tbody", {}, row("Present", this.plate.outputs), row("Power-on", settings.powerOn),
          row("Safe", settings.safe))));
  }

  copyText(copy, index) {
    const state = !copy.good ? (/^F*$/.test(copy.bytes) ? "blank" : "not valid")
      : `sequence ${copy.sequence}${index === this.stored.current ? ", in use" : ""}`;
    return make("div", {class: "copy"}, make("h4", {}, `Copy ${index + 1}: ${state}`),
      make("code", {}, copy.bytes.match(/../g).join(" ")));
  }
}
