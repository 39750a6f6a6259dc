// The page of the panel. It shows what the program's messages contain, and sends the user's commands and requests.

import {Console} from "/console.js";
import {setText} from "/element.js";
import {Faults} from "/faults.js";
import {LineView, mostUnfolded} from "/line_view.js";
import {Live} from "/live.js";
import {Plate} from "/plate.js";
import {Timeline} from "/timeline.js";

const at = (id) => document.getElementById(id);
const timeline = new Timeline();
let run = null;
let version = null;
let speed = 1;
/// The plates that exist, by position, and the state of every module.
let plates = [];
let states = [];
let lines = [];
/// For each line, the time of its clock in us (`showed`), and the time in ms at which it arrived (`when`).
let clocks = [];
let fresh = [];
let due = false;

const now = (line) => {
  const clock = clocks[line];
  return clock ? clock.showed + (performance.now() - clock.when) * 1000 * speed : 0;
};

function begin(hello) {
  if (version !== null && hello.version !== version) {
    location.reload();  // the files of the page may have changed too
    return;
  }
  version = hello.version;
  speed = hello.speed;
  clocks = [];
  if (hello.run === run) {
    return;
  }
  run = hello.run;
  document.body.dataset.simulated = hello.simulated;
  document.title = hello.simulated ? "ex9000-sim" : "ex9000";
  setText(at("program"), document.title);
  const several = hello.lines.length > 1;
  const [first] = hello.lines;
  setText(at("about"), [hello.version, hello.modules.length > 1 ? `${hello.modules.length} modules` : "",
    several ? `${hello.lines.length} lines` : [first.name, first.ports.join(", ")].filter(Boolean).join(": ")]
    .filter(Boolean).join(" · "));
  const wayOfClicks = () => document.querySelector("input[name=way]:checked").value;
  const plateOf = (position) => {
    const its = (command) => command && `${position + 1} ${command}`;
    plates[position] ??= new Plate(hello.modules[position], position, states[position],
      (command, undo) => live.tell(its(command), its(undo)), wayOfClicks);
    return plates[position];
  };
  plates = [];
  states = hello.modules.map(() => ({}));
  const count = states.length === 1 ? "one" : states.length > 8 ? "many" : "some";
  const unfolded = states.length <= mostUnfolded;
  const modulesOf = hello.lines.map(() => []);
  hello.modules.forEach(({model, line}, position) => modulesOf[line].push({position, model}));
  lines = hello.lines.map((line, index) => {
    const modules = modulesOf[index];
    const faults = new Faults(line, {several, unfolded, usual: hello.usualFaults}, modules,
      (command) => live.tell(command));
    const view = several ? new LineView(line, modules, count, unfolded, states, plateOf) : null;
    const console = new Console(line, {several, index}, modules, states, (request) => live.send(request));
    return {...line, modules, faults, view, console};
  });
  at("finder").hidden = !several;
  at("find").value = "";
  at("plates").dataset.count = count;
  at("plates").replaceChildren(...(several ? lines.map(({view}) => view.element)
    : states.map((_, position) => plateOf(position).element)));
  at("faultlines").replaceChildren(...lines.map((line) => line.faults.element));
  at("consoles").replaceChildren(...lines.map((line) => line.console.element));
  timeline.begin(lines, (line, station) => {
    if (station === undefined) {
      return several ? lines[line].name : "line";
    }
    const module = station ? lines[line].modules[station - 1] : null;
    const who = station === 0 ? "master" : module ? `${module.position + 1} ${module.model}` : "unknown sender";
    return several ? `${lines[line].name}: ${who}` : who;
  }, now);
}

/// Shows only the modules that match the words in `find`, and opens their lines, or folds them if more than
/// `mostUnfolded` match. Hides the faults and the console of a line without any.
function find() {
  const words = at("find").value.toLowerCase().split(/\s+/).filter(Boolean);
  const found = lines.map(({view}) => view.matches(words));
  const total = found.reduce((sum, modules) => sum + modules.length, 0);
  lines.forEach(({view, faults, console}, index) => {
    view.show(found[index], found[index].length > 0 && total <= mostUnfolded);
    faults.element.hidden = console.element.hidden = !found[index].length;
  });
  setText(at("found"), words.length ? `${total} ${total === 1 ? "module" : "modules"} found` : "");
}

function show(message) {
  message.state?.modules.forEach(({module, ...news}) => {
    Object.assign(states[module], news);
    plates[module]?.show(news);
  });
  message.state?.lines.forEach(({faults}, index) => {
    if (faults) {
      lines[index].faults.show(faults);
    }
  });
  if (message.frames) {
    timeline.add(message.frames);
  }
  [...message.answers ?? [], message.reply].filter(Boolean).forEach((reply) => live.answer(reply));
}

function take(message) {
  if (message.hello) {
    fresh = [];
    begin(message.hello);
  }
  const when = performance.now();
  message.state?.lines.forEach((line, index) => { clocks[index] = {showed: line.now, when}; });
  fresh.push(message);
  // The browser does not repaint a hidden page, so messages would accumulate.
  if (document.hidden && !due) {
    due = true;
    setTimeout(() => { due = false; fresh.splice(0).forEach(show); }, 200);
  }
}

/// Once per repaint: new messages, countdowns and traffic.
function repaint(when) {
  fresh.splice(0).forEach(show);
  plates.forEach((plate) => plate.tick(now(plate.layout.line)));
  timeline.draw(when);
  requestAnimationFrame(repaint);
}

/// Why the page is not connected.
const reasons = {
  gone: "Not connected to the program; trying again. The page shows the last known state.",
  tooMany: "Too many pages are open. This page connects when another page is closed.",
};

function lost(why) {
  document.body.dataset.link = why ? "lost" : "there";
  setText(at("link"), why ? "not connected" : "connected");
  setText(at("lost"), why ? reasons[why] : "");
  if (why) {
    plates.forEach((plate) => plate.lost());
    lines.forEach(({console}) => console.stop());
  }
}

/// If the window is wider than 640 px, the stylesheet needs its height to place `lost` and scroll targets.
const header = document.querySelector(".top");
const measure = () => document.documentElement.style.setProperty("--top", `${header.offsetHeight}px`);
new ResizeObserver(measure).observe(header);

at("find").addEventListener("input", find);
const live = new Live(take, lost);
requestAnimationFrame(repaint);
