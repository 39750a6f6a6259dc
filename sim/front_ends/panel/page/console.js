// The console of a line: sends a request to one module or to all modules, once or repeatedly, and shows the replies.

import {hexByte, make} from "/element.js";

const mostReplies = 50;
const intervals = [["200", "0.2 s"], ["1000", "1 s"], ["5000", "5 s"]];
const everyModule = "all";
/// The most bits, and the most registers, that one request can read.
const mostBits = 2000;
const mostWords = 125;

let models = null;

/// A map from the name of each model to its description (`describe --format json`); empty if the request fails.
function described() {
  models ??= fetch("/models.json").then((response) => response.json()).then((all) =>
    new Map(all.models.map((model) => [model.model, model]))).catch(() => {
    models = null;  // the next call tries again
    return new Map();
  });
  return models;
}

const isDcon = (text) => /^[$#%@~]/.test(text);
const hexWord = (value) => value.toString(16).toUpperCase().padStart(4, "0");

/// {label, request} for each row of a model's register map and each function from 01 to 06 of this row.
function modbusItems(model) {
  return model.modbus_registers.flatMap(({first, last, functions, meaning}) => functions.flatMap((code) => {
    const span = first === last ? hexWord(first) : `${hexWord(first)}–${hexWord(last)}`;
    const item = (verb, ...words) => [{label: `${verb} ${span}: ${meaning}`,
      request: [hexByte(code), ...words.map(hexWord)].join(" ")}];
    const count = Math.min(last - first + 1, code <= 2 ? mostBits : mostWords);
    return code <= 4 ? item("Read", first, count)
      : code === 5 ? item("Write", first, 0xFF00) : code === 6 ? item("Write", first, 0) : [];
  }));
}

/// {label, request} for each DCON command of a model. `address` replaces AA.
function dconItems(model, address) {
  return model.dcon_commands.map(({command, meaning}) => ({
    label: `${command}: ${meaning}`,
    request: command.replace(/^(.)AA/, `$1${hexByte(address)}`),
  }));
}

export class Console {
  /// `several`: there are several lines. `index`: of the line, from 0. `modules`: {position, model} of each. `states`:
  /// theirs, by position. `ask(request)`: see `send` in live.js.
  constructor(line, {several, index}, modules, states, ask) {
    this.index = index;
    this.modules = modules;
    this.states = states;
    this.ask = ask;
    this.timer = null;
    const name = line.name || "the line";
    this.module = make("select", {"aria-label": `Module on ${name}`, onchange: () => this.fillItems()});
    this.item = make("select", {"aria-label": `Item for ${name}`, onchange: () => this.choose()});
    this.text = make("input", {type: "text", size: "28", autocomplete: "off", spellcheck: "false", maxlength: "900",
      placeholder: "01 0000 0008 or $01M", "aria-label": `Request on ${name}`});
    this.poll = make("input", {type: "checkbox", onchange: () => this.schedule(0)});
    this.interval = make("select", {"aria-label": `Interval on ${name}`, onchange: () => this.schedule(0)},
      ...intervals.map(([value, label]) => make("option", {value, selected: value === "1000"}, label)));
    this.replies = make("div", {class: "replies", role: "log", "aria-label": `Replies on ${name}`, tabindex: "0"});
    const form = make("form", {class: "bar", onsubmit: (event) => {
      event.preventDefault();
      this.send();
    }}, this.module, this.item, this.text, make("button", {type: "submit"}, "Send"),
    make("label", {}, this.poll, " every"), this.interval);
    this.element = make("details", {class: "console", ontoggle: () => this.open()},
      make("summary", {}, make("h3", {}, several ? line.name : "Send a request")), form, this.replies);
  }

  /// Fills the lists now, because addresses and protocols can change before. Polling stops when the console is closed.
  open() {
    if (!this.element.open) {
      this.stop();
      return;
    }
    this.module.replaceChildren(...this.modules.map(({position, model}) => {
      const {plate} = this.states[position];
      const address = plate?.listening ? ` at ${hexByte(plate.address)}` : "";
      return make("option", {value: String(position)}, `${position + 1} ${model}${address}`);
    }), make("option", {value: everyModule}, "all modules"));
    this.fillItems();
  }

  get plate() { return this.states[Number(this.module.value)]?.plate; }

  async fillItems() {
    const chosen = this.modules.find(({position}) => String(position) === this.module.value);
    const all = await described();
    const model = all.get(chosen?.model);
    const {plate} = this;
    const items = !model || !plate?.listening ? []
      : plate.protocol === "modbus" ? modbusItems(model) : dconItems(model, plate.address);
    const hint = items.length ? "choose or type a request" : "type a request";
    this.item.replaceChildren(make("option", {value: ""}, hint),
      ...items.map(({label, request}) => make("option", {value: request}, label)));
  }

  choose() {
    if (this.item.value !== "") {
      this.text.value = this.item.value;
    }
  }

  /// With a checksum after a DCON command if the chosen module expects one.
  get request() {
    const text = this.text.value.trim();
    if (!isDcon(text) || this.module.value === everyModule || !this.plate?.checksum) {
      return text;
    }
    return text + hexByte([...text].reduce((sum, character) => sum + character.charCodeAt(0), 0) & 0xFF);
  }

  async send() {
    const ask = this.request;
    if (!ask) {
      return;
    }
    // A DCON command contains its address, which may be higher than the highest Modbus address.
    const address = isDcon(ask) || this.module.value === everyModule ? 0 : this.plate?.address ?? 1;
    const reply = await this.ask({line: this.index, address, ask});
    this.show(ask, reply);
  }

  show(asked, {ok, text, meaning, delay}) {
    const took = delay === undefined ? "" : `${(delay / 1000).toFixed(2)} ms`;
    this.replies.append(make("div", {"data-ok": ok}, make("code", {}, asked), " → ", make("code", {}, text ?? ""),
      meaning ? ` ${meaning}` : "", " ", make("span", {class: "quiet"}, took)));
    while (this.replies.children.length > mostReplies) {
      this.replies.firstChild.remove();
    }
    this.replies.scrollTop = this.replies.scrollHeight;
  }

  /// While polling is on, sends after `delay` ms, and again at the chosen interval after each reply or error.
  schedule(delay) {
    clearTimeout(this.timer);
    if (!this.poll.checked) {
      return;
    }
    this.timer = setTimeout(async () => {
      await this.send();
      this.schedule(Number(this.interval.value));
    }, delay);
  }

  stop() {
    this.poll.checked = false;
    this.schedule(0);
  }
}
