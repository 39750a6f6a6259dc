// Checks the flows for Node-RED with Node-RED's own parser of flows, and with the properties and validators that the
// nodes of node-red-contrib-modbus declare to the editor.
"use strict";
const assert = require("node:assert/strict");
const { execFileSync } = require("node:child_process");
const fs = require("node:fs");
const path = require("node:path");
const { test } = require("node:test");
const { parseFlow } = require("@node-red/flow-parser");

const PROGRAM = process.env.EX9000_SIMULATOR ?? path.join(__dirname, "../../../../build/host-debug/sim/ex9000-sim");
const NODES = path.dirname(require.resolve("node-red-contrib-modbus/package.json"));
const OF_EVERY_NODE = ["id", "type", "z", "x", "y", "wires"];

function run(...words) {
  return execFileSync(PROGRAM, words, { encoding: "utf8" });
}

function flowOf(model, ...options) {
  return JSON.parse(run("describe", model, "--format", "node-red", ...options));
}

const MODELS = run("--models").split("\n").filter((line) => line.includes("Modbus RTU"))
  .map((line) => line.split(" ")[0]);

/// Reads the HTML file that shows nodes of this type in the editor: the declaration that its script registers, and the
/// values that its lists offer for a property.
function editorOf(type) {
  const html = fs.readFileSync(path.join(NODES, "modbus", `${type}.html`), "utf8");
  const script = /<script type='text\/javascript'>([^]*?)<\/script>/.exec(html)[1];
  let declared = null;
  const RED = {
    nodes: { registerType: (_, declaration) => { declared = declaration; } },
    validators: { number: () => (value) => value !== "" && !Number.isNaN(Number(value)) },
  };
  new Function("RED", script)(RED);
  const offered = (key) => {
    const list = new RegExp(`<select[^>]*input-${key}'[^]*?</select>`).exec(html);
    return list && [...list[0].matchAll(/value='([^']*)'/g)].map((match) => match[1]);
  };
  return { declared, offered };
}

/// Returns what the editor would mark as wrong in the properties of a node.
function mistakesOf(node) {
  const { declared, offered } = editorOf(node.type);
  const mistakes = Object.keys(node).filter((key) => !(key in declared.defaults) && !OF_EVERY_NODE.includes(key))
    .map((key) => `${node.type} has no property ${key}`);
  for (const [key, { value, required, validate }] of Object.entries(declared.defaults)) {
    const used = node[key] ?? value;
    if ((required && (used === undefined || used === "")) || (validate && !validate.call(node, used))) {
      mistakes.push(`${node.type}.${key} is ${used}`);
    }
    if (key in node && offered(key) && !offered(key).includes(node[key])) {
      mistakes.push(`${node.type}.${key} is ${node[key]}, expected one of ${offered(key)}`);
    }
  }
  if (node.wires && node.wires.length !== declared.outputs) {
    mistakes.push(`${node.type} has ${declared.outputs} outputs`);
  }
  return mistakes;
}

test("the editor accepts the properties of every node", () => {
  assert.ok(MODELS.length >= 8);
  for (const model of MODELS) {
    for (const options of [[], ["--port", "modbus-tcp:192.0.2.7:502", "--address", "f7"]]) {
      const nodes = flowOf(model, ...options).filter(({ type }) => type.startsWith("modbus-"));
      assert.ok(nodes.length > 0);
      nodes.forEach((node) => assert.deepEqual(mistakesOf(node), [], model));
    }
  }
});

test("Node-RED finds the tab, the client and the target of each wire", () => {
  for (const model of MODELS) {
    const nodes = flowOf(model);
    const flow = parseFlow(nodes);
    const [tab] = [...flow.flows.values()];
    const [client] = [...flow.configNodes.values()];
    assert.deepEqual([flow.flows.size, flow.configNodes.size, flow.nodes.size], [1, 1, nodes.length - 2]);
    assert.equal(tab.nodes.size, flow.nodes.size);
    assert.equal(client.users.size, nodes.filter(({ server }) => server).length);
    assert.equal(flow.wires.length, nodes.flatMap(({ wires = [] }) => wires.flat()).length);
    const places = [...flow.nodes.values()].map(({ x, y }) => `${x} ${y}`);
    assert.equal(new Set(places).size, places.length);
  }
});

test("ids are stable, and differ between modules", () => {
  const idsOf = (...words) => flowOf(...words).map(({ id }) => id);
  const ids = idsOf("EX9042D-M");
  assert.deepEqual(idsOf("EX9042D-M", "--port", "modbus-tcp:192.0.2.7:4001"), ids);
  const others = new Set([...idsOf("EX9042D-M", "--address", "02"), ...idsOf("EX9043D-M")]);
  assert.ok(ids.every((id) => !others.has(id)));
});
