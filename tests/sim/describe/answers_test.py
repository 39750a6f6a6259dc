#!/usr/bin/env python3
"""What the maps name is there: the simulated module answers all of it, and does what it is said to do."""

import json
import re
import unittest

import yaml

from line import Line
from program import describe, models_with_modbus

# The words of the tools for what Line calls coil, discrete_input, holding and input.
NODE_RED = {"Coil": "coil", "Input": "discrete_input", "HoldingRegister": "holding", "InputRegister": "input"}
WIREN_BOARD = {"coil": "coil", "discrete": "discrete_input", "holding": "holding", "input": "input"}


class EveryMap(unittest.TestCase):
    def of_each_model(self, play):
        for model in models_with_modbus():
            with self.subTest(model=model), Line(model) as line:
                play(line, model)

    def expect_switch(self, line, read, write):
        for on in [True, False]:
            line.write_coil(write, on)
            self.assertEqual(line.read(*read), [int(on)])

    def test_home_assistants_entities(self):
        def play(line, model):
            text = describe(model, "--format", "home-assistant")
            hub = yaml.safe_load(text)[0]
            for switch in hub.get("switches", []):
                verify = switch["verify"]
                self.expect_switch(line, (verify["input_type"], verify["address"]), switch["address"])
            for sensor in hub.get("binary_sensors", []) + hub.get("sensors", []):
                line.read(sensor["input_type"], sensor["address"])
            actions = re.findall(r"modbus\.write_coil .* address: (\d+), state: true", text)
            self.assertTrue(actions)
            for address in actions:
                line.write_coil(int(address), True)

        self.of_each_model(play)

    def test_node_reds_nodes(self):
        def play(line, model):
            nodes = {node["id"]: node for node in json.loads(describe(model, "--format", "node-red"))}
            for node in nodes.values():
                if node["type"] == "modbus-read":
                    line.read(NODE_RED[node["dataType"]], int(node["adr"]), int(node["quantity"]))
                elif node["type"] == "inject":
                    for target in node["wires"][0]:
                        line.write_coil(int(nodes[target]["adr"]), node["payload"] == "true")

        self.of_each_model(play)

    def test_wiren_boards_channels(self):
        def play(line, model):
            device = json.loads(describe(model, "--format", "wb-mqtt-serial"))["device"]
            for channel in device["channels"]:
                if "address" in channel:
                    line.read(WIREN_BOARD[channel["reg_type"]], channel["address"])
                if "write_address" in channel:
                    line.write_coil(channel["write_address"], True)
                elif not channel.get("readonly"):
                    self.expect_switch(line, ("coil", channel["address"]), channel["address"])

        self.of_each_model(play)


if __name__ == "__main__":
    unittest.main()
