#!/usr/bin/env python3
"""Checks the properties, ids, wires and positions of the nodes in the Node-RED flows of `ex9000-sim describe`.

node_red_contrib_modbus.json lists the valid properties of the types of nodes that the flows use.
"""

import copy
import json
import pathlib
import unittest

from program import describe, models_with_modbus

KNOWN = json.loads(pathlib.Path(__file__).with_name("node_red_contrib_modbus.json").read_text(encoding="utf-8"))


def flow(model, *arguments):
    return json.loads(describe(model, "--format", "node-red", *arguments))


def wrong_properties(node):
    known = KNOWN["nodes"][node["type"]]
    for key in node:
        if key not in KNOWN["anywhere"] + known["properties"]:
            yield f"{key} is not a property of {node['type']}"
    for key in known["required"]:
        if key not in node:
            yield f"{node['type']} requires {key}"
    for key, values in known.get("values", {}).items():
        if key in node and node[key] not in values:
            yield f"{node['id']}: {key} is {node[key]}; expected one of {', '.join(map(str, values))}"


def wrong_wires(node, nodes):
    known = KNOWN["nodes"][node["type"]]
    if known.get("config"):
        if "wires" in node:
            yield f"{node['id']}: has wires; a node of the type {node['type']} has no outputs"
        return
    if len(node["wires"]) != known["outputs"]:
        yield f"{node['id']}: has wires for {len(node['wires'])} outputs; {node['type']} has {known['outputs']}"
    for target in (target for output in node["wires"] for target in output):
        if target not in nodes or KNOWN["nodes"][nodes[target]["type"]].get("inputs", 0) == 0:
            yield f"a wire of {node['id']} has no valid target"
    if nodes.get(node["z"], {}).get("type") != "tab":
        yield f"{node['id']} is not on a tab"
    if "server" in node and nodes.get(node["server"], {}).get("type") != "modbus-client":
        yield f"{node['id']} has no client"


def mistakes(all_nodes):
    """Returns descriptions of the errors in a flow; an empty list if the flow is valid."""
    unknown = {node["type"] for node in all_nodes} - set(KNOWN["nodes"])
    if unknown:
        return [f"unknown type of node {', '.join(unknown)}; expected one of {', '.join(KNOWN['nodes'])}"]
    nodes = {node["id"]: node for node in all_nodes}
    found = [] if len(nodes) == len(all_nodes) else ["two nodes have the same id"]
    for node in all_nodes:
        found += [*wrong_properties(node), *wrong_wires(node, nodes)]
    places = [(node["x"], node["y"]) for node in all_nodes if "x" in node]
    return found if len(set(places)) == len(places) else [*found, "two nodes have the same position"]


class NodeRed(unittest.TestCase):
    def test_every_flow_is_valid(self):
        models = models_with_modbus()
        self.assertGreaterEqual(len(models), 5)
        for model in models:
            with self.subTest(model=model):
                self.assertEqual(mistakes(flow(model)), [])
                self.assertEqual(mistakes(flow(model, "--modbus-tcp", "192.0.2.7:502")), [])

    def test_ids_are_stable_and_differ_between_modules(self):
        ids = [node["id"] for node in flow("EX9042D-M")]
        for option in ["--tcp", "--modbus-tcp"]:
            self.assertEqual(ids, [node["id"] for node in flow("EX9042D-M", option, "192.0.2.7:4001")])
        others = flow("EX9042D-M", "--address", "02") + flow("EX9043D-M")
        self.assertEqual(set(ids) & {node["id"] for node in others}, set())

    def test_the_checks_find_the_errors_of_a_wrong_flow(self):
        right = flow("EX9052D-M")
        of = {node["type"]: number for number, node in enumerate(right)}
        wrong = [
            lambda nodes: nodes[of["debug"]].update(id=right[of["tab"]]["id"]),
            lambda nodes: nodes[of["inject"]].update(wires=[["0"]]),
            lambda nodes: nodes[of["inject"]].update(wires=[]),
            lambda nodes: nodes[of["inject"]].update(wires=[[right[of["modbus-read"]]["id"]]]),
            lambda nodes: nodes[of["modbus-read"]].update(server="0"),
            lambda nodes: nodes[of["modbus-read"]].update(z="0"),
            lambda nodes: nodes[of["modbus-read"]].update(address=0),
            lambda nodes: nodes[of["modbus-read"]].update(dataType="DiscreteInput"),
            lambda nodes: nodes[of["modbus-read"]].pop("rate"),
            lambda nodes: nodes[of["modbus-write"]].update(type="modbus-writer"),
            lambda nodes: nodes[of["modbus-client"]].update(tcpType="RTU"),
            lambda nodes: nodes[of["debug"]].update(y=nodes[of["modbus-write"]]["y"], x=nodes[of["modbus-write"]]["x"]),
        ]
        for number, change in enumerate(wrong):
            with self.subTest(number=number):
                changed = copy.deepcopy(right)
                change(changed)
                self.assertNotEqual(mistakes(changed), [])


if __name__ == "__main__":
    unittest.main()
