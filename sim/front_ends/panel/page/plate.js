// A module's face plate: its terminals, LEDs, readouts and switches, and the folded list of its values (drawer.js).

import {Drawer} from "/drawer.js";
import {bit, hexByte, make, setAttribute, setText, terminal} from "/element.js";
import {Input} from "/input.js";
import {Switch} from "/switch.js";

const edgeTerminals = ["DATA+", "DATA−", "+VS", "GND"];

export class Plate {
  /// `position`: from 0. `state`: the parts that have arrived; the caller updates it. `tell(command, undo)`: see
  /// live.js, but without the module's number. `way()`: what a click without Shift or Alt does to an input: toggle,
  /// hold or pulse.
  constructor(layout, position, state, tell, way) {
    this.layout = layout;
    this.state = state;
    this.tell = tell;
    this.title = `${position + 1} ${layout.model}`;
    this.outputs = layout.outputs.map((label) => this.makeOutput(label));
    this.inputs = layout.inputs.map((label, channel) => new Input(this.title, label, channel,
      layout.simulated ? tell : null, way));
    this.element = this.build();
    this.show(state);
  }

  build() {
    const name = (text) => `${this.title}: ${text}`;
    this.name = make("span", {class: "name"});
    this.led = make("span", {class: "led status", role: "img", "aria-label": "Status LED"});
    this.ledText = make("span", {class: "ledtext"});
    this.power = Switch.withKnob(name("power"), "rocker", (on) => this.tell(`power ${on ? "on" : "off"}`));
    this.init = Switch.withKnob(name("INIT* to GND"), "slide", (on) => this.tell(`init ${on ? "on" : "off"}`));
    this.reset = make("button", {type: "button", class: "reset", "aria-label": name("reset"),
      onclick: () => this.tell("reset")}, "Reset");
    this.address = this.readout("Address");
    this.serialNumber = this.readout("Serial number");
    this.baud = this.readout("Baud");
    this.protocol = this.readout("Protocol");
    this.hostWatchdog = this.readout("Host watchdog", "wide");
    this.bar = make("span", {class: "countdown", "aria-hidden": "true"}, make("span"));
    this.hostWatchdog.box.append(this.bar);
    this.drawer = new Drawer(this.layout, this.title, this.state);
    const edge = this.layout.initTerminal ? ["INIT*", ...edgeTerminals] : edgeTerminals;
    return make("article", {class: "plate", "aria-label": this.title},
      make("div", {class: "head"},
        make("div", {class: "title"}, make("h3", {}, this.layout.model), this.name),
        make("div", {class: "lamp"}, this.led, this.ledText)),
      make("div", {class: "readouts"}, this.address.box, this.baud.box, this.protocol.box,
        this.hostWatchdog.box, this.serialNumber.box),
      this.strip("outputs", "Outputs", this.outputs), this.strip("inputs", "Inputs", this.inputs),
      make("div", {class: "controls simulated"},
        make("span", {class: "control"}, make("span", {"aria-hidden": "true"}, "Power"), this.power.element),
        make("span", {class: "control"}, make("span", {"aria-hidden": "true"}, "INIT*"), this.init.element),
        this.reset),
      this.drawer.element,
      make("ul", {class: "edge", "aria-hidden": "true"},
        ...edge.map((label) => make("li", {}, make("span", {class: "screw"}), label))));
  }

  /// Outputs or inputs; "" if there are none. More than eight terminals use two rows; blank items fill the last one.
  strip(className, name, channels) {
    if (!channels.length) {
      return "";
    }
    const columns = channels.length > 8 ? Math.ceil(channels.length / 2) : Math.max(channels.length, 4);
    const blank = Math.ceil(channels.length / columns) * columns - channels.length;
    const list = make("ul", {class: `channels ${className}`, "aria-label": name}, ...channels.map(({item}) => item),
      ...Array.from({length: blank}, () => make("li", {"aria-hidden": "true"})));
    list.style.setProperty("--columns", columns);
    return list;
  }

  readout(label, extra = "") {
    const value = make("span", {class: "value"});
    return {value, box: make("span", {class: `readout ${extra}`}, make("span", {class: "label"}, label), value)};
  }

  makeOutput(label) {
    const led = make("span", {class: "led output", role: "img", "aria-label": `${label} off`});
    const left = make("span", {class: "left", hidden: ""});
    return {label, led, left, item: terminal(label, led, left)};
  }

  /// When the connection is lost.
  lost() { this.inputs.forEach((input) => input.lost()); }

  /// The parts in `news`, which may be empty. `state` must contain them too.
  show(news) {
    if (news.plate) {
      this.showPlate(news.plate);
    }
    if (news.records) {
      const {counters, high, low} = news.records;
      this.inputs.forEach((input, channel) =>
        input.showGathered(counters[channel], bit(high, channel), bit(low, channel)));
    }
    if (news.stored) {
      setText(this.name, news.stored.settings.name);
    }
    this.drawer.draw();
  }

  showPlate(plate) {
    setAttribute(this.element, "data-powered", plate.powered);
    this.power.show(plate.switch);
    this.init.show(plate.init);
    this.reset.disabled = !plate.powered;
    const flashing = plate.led.startsWith("flashing");
    setAttribute(this.led, "data-led", plate.led === "flashing" ? "flashing" : flashing ? "unreadable" : plate.led);
    setAttribute(this.led, "aria-label", `Status LED ${plate.led}`);
    const supply = plate.switch && !plate.powered ? "no supply" : plate.led;
    setText(this.ledText, plate.initMode ? `${supply}, INIT mode` : supply);
    setText(this.address.value, plate.address === undefined ? "––" : hexByte(plate.address));
    setText(this.serialNumber.value, plate.serialNumber ?? "––");
    setText(this.baud.value, plate.baud === undefined ? "––" : `${plate.baud} ${plate.format}`);
    const protocols = {modbus: "RTU", ascii: plate.checksum ? "ASCII+Σ" : "ASCII"};
    setText(this.protocol.value, protocols[plate.protocol] ?? "––");
    this.outputs.forEach(({label, led, left}, channel) => {
      const lit = bit(plate.outputs, channel);
      const tenths = plate.timers?.[channel] ?? 0;
      setAttribute(led, "data-on", lit);
      setAttribute(led, "aria-label", `${label} ${plate.outputs === undefined ? "unknown" : lit ? "on" : "off"}`);
      left.hidden = tenths === 0;
      setText(left, `${(tenths / 10).toFixed(1)} s`);
    });
    this.inputs.forEach((input, channel) => input.show(bit(plate.inputs, channel)));
  }

  /// The readout and the countdown of the host watchdog. `now`: the time of the line's clock in us.
  tick(now) {
    const {plate, hostWatchdog} = this.state;
    if (!hostWatchdog) {
      return;
    }
    if (!this.layout.simulated) {
      const known = plate?.listening;
      setText(this.hostWatchdog.value, !known ? "––" : hostWatchdog.timedOut ? "timed out"
        : hostWatchdog.enabled ? hostWatchdog.timeout : "off");
      setAttribute(this.hostWatchdog.box, "data-state", known && hostWatchdog.timedOut ? "expired" : "off");
      return;
    }
    const total = hostWatchdog.timeout * 1e5;
    const left = hostWatchdog.expires === null ? 0 : Math.max(0, hostWatchdog.expires - now);
    let text = "off";
    if (!plate?.listening) {
      text = "––";
    } else if (hostWatchdog.timedOut) {
      text = "timed out";
    } else if (hostWatchdog.enabled) {
      text = `${(left / 1e6).toFixed(1)} s of ${(total / 1e6).toFixed(1)} s`;
    }
    setText(this.hostWatchdog.value, text);
    const state = hostWatchdog.timedOut ? "expired" : hostWatchdog.enabled ? "runs" : "off";
    setAttribute(this.hostWatchdog.box, "data-state", state);
    const share = hostWatchdog.enabled && total ? Math.round(100 * left / total) : 0;
    if (share !== this.share) {
      this.share = share;
      this.bar.firstChild.style.inlineSize = `${share}%`;
    }
  }
}
