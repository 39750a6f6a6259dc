#!/usr/bin/env python3
"""Tests that a simulated module supports the reads and coil writes in the exports for ESPHome, Home Assistant, Node-RED
and wb-mqtt-serial. Also tests that these exports contain all coil writes of `coils_to_write`, and that the exports for
ESPHome and Node-RED contain all reads of `ranges_to_read`.
"""

import json
import re
import unittest

import yaml

from line import Line
from program import ROOT, describe, models_with_modbus

# These dictionaries map the terms of the tools to the terms of Line: coil, discrete_input, holding and input.
ESPHOME = {"coil": "coil", "discrete_input": "discrete_input", "holding": "holding", "read": "input"}
NODE_RED = {"Coil": "coil", "Input": "discrete_input", "HoldingRegister": "holding", "InputRegister": "input"}
WIREN_BOARD = {"coil": "coil", "discrete": "discrete_input", "holding": "holding", "input": "input"}

# The number of outputs and the number of inputs of each model, from section 1 of wire.md. A row of its table begins
# with the model, the inputs and the outputs.
CHANNELS = {
    model: (int(outputs or 0), int(inputs or 0))
    for model, inputs, outputs in re.findall(r"^\| (EX\w+(?:-M)?) \| (\d*)[^|]* \| (\d*)[^|]* \|",
                                             (ROOT / "firmware/wire.md").read_text(encoding="utf-8"), re.MULTILINE)
}


def coils_to_write(model):
    """Returns the address and the value of each coil write that all exports must contain (wire.md section 7).

    These writes switch the outputs, and clear latches, counters and the timeout status.
    """
    outputs, inputs = CHANNELS[model]
    switched = {(address, on) for address in range(outputs) for on in [True, False]}
    cleared = {0x010D} | ({0x0107} | {0x0200 + counter for counter in range(inputs)} if inputs else set())
    return switched | {(address, True) for address in cleared}


def ranges_to_read(model, presets):
    """Returns the kind, the first address and the size of each range that an export must read (wire.md section 7).

    `presets`: whether the export also reads the safe values and the power-on values.
    """
    outputs, inputs = CHANNELS[model]
    rows = {("coil", 0x0104, 1), ("coil", 0x010D, 1), ("holding", 0x01E8, 1)}
    if outputs:
        rows |= {("coil", first, outputs) for first in ((0x0000, 0x0080, 0x00A0) if presets else (0x0000,))}
    if inputs:
        rows |= {("discrete_input", 0x0000, inputs), ("input", 0x0000, inputs)}
        rows |= {("coil", first, inputs) for first in (0x0040, 0x0060)}
    return rows


class EveryMap(unittest.TestCase):
    def of_each_model(self, play):
        for model in models_with_modbus():
            with self.subTest(model=model), Line(model) as line:
                play(line, model)

    def expect_switch(self, line, read, write):
        for on in [True, False]:
            line.write_coil(write, on)
            self.assertEqual(line.read(*read), [int(on)])

    def test_home_assistant_switches_every_output_reads_every_sensor_and_has_every_action(self):
        def play(line, model):
            text = describe(model, "--format", "home-assistant")
            hub = yaml.safe_load(text)[0]
            switches, sensors = hub.get("switches", []), hub.get("binary_sensors", []) + hub.get("sensors", [])
            self.assertEqual({switch["address"] for switch in switches}, set(range(CHANNELS[model][0])))
            for switch in switches:
                verify = switch["verify"]
                self.expect_switch(line, (verify["input_type"], verify["address"]), switch["address"])
            inputs = CHANNELS[model][1]
            for sensor in sensors:
                count = 1 + sensor.get("virtual_count", 0)
                self.assertEqual(len(line.read(sensor["input_type"], sensor["address"], count)), count)
                # a row of channels with one request
                self.assertEqual(count, 1 if "Host watchdog" in sensor["name"] else inputs, sensor["name"])
            actions = re.findall(r"modbus\.write_coil .* address: (\d+), state: true", text)
            cleared = {address for address, _ in coils_to_write(model)} - set(range(CHANNELS[model][0]))
            enable = 0x0104  # enables the host watchdog
            self.assertEqual({int(address) for address in actions}, cleared | {enable})
            self.assertEqual(re.findall(r"modbus\.write_register .* address: (\d+), value: 1", text), [str(0x0251)])
            for address in actions:
                line.write_coil(int(address), True)

        self.of_each_model(play)

    def test_node_red_has_every_required_read_and_write_and_each_succeeds(self):
        def play(line, model):
            nodes = {node["id"]: node for node in json.loads(describe(model, "--format", "node-red"))}
            read, written = set(), set()
            for node in nodes.values():
                if node["type"] == "modbus-read":
                    first, count = int(node["adr"]), int(node["quantity"])
                    kind = NODE_RED[node["dataType"]]
                    self.assertEqual(len(line.read(kind, first, count)), count)
                    read.add((kind, first, count))
                elif node["type"] == "inject":
                    self.assertIn(node["payload"], ["true", "false"])
                    on = node["payload"] == "true"
                    for target in node["wires"][0]:
                        address = int(nodes[target]["adr"])
                        line.write_coil(address, on)
                        written.add((address, on))
                        if address < CHANNELS[model][0]:
                            self.assertEqual(line.read("coil", address), [int(on)])
            self.assertEqual(read, ranges_to_read(model, presets=True))
            self.assertEqual(written, coils_to_write(model))

        self.of_each_model(play)

    def test_esphome_has_every_required_read_and_write_and_each_succeeds(self):
        def play(line, model):
            node = yaml.safe_load(describe(model, "--format", "esphome"))
            self.assertEqual([controller["address"] for controller in node["modbus_controller"]], [1])
            read, written = set(), set()
            for switch in node.get("switch", []):
                self.assertEqual(switch["register_type"], "coil")
                self.expect_switch(line, ("coil", switch["address"]), switch["address"])
                written |= {(switch["address"], True), (switch["address"], False)}
            for item in node.get("switch", []) + node["binary_sensor"] + node["sensor"]:
                kind = ESPHOME[item["register_type"]]
                self.assertEqual(len(line.read(kind, item["address"])), 1)
                read.add((kind, item["address"]))
            outputs = {output["id"]: output["address"] for output in node["output"]}
            for button in node["button"]:
                address = outputs[button["on_press"][0]["output.turn_on"]]
                line.write_coil(address, True)
                written.add((address, True))
            ranges = ranges_to_read(model, presets=False)
            self.assertEqual(read, {(kind, first + i) for kind, first, size in ranges for i in range(size)})
            self.assertEqual(written, coils_to_write(model))

        self.of_each_model(play)

    def test_wb_mqtt_serial_reads_its_channels_and_writes_every_required_coil(self):
        def play(line, model):
            device = json.loads(describe(model, "--format", "wb-mqtt-serial"))["device"]
            written = set()
            for channel in device["channels"]:
                if "address" in channel:
                    self.assertEqual(len(line.read(WIREN_BOARD[channel["reg_type"]], channel["address"])), 1)
                if "write_address" in channel:
                    line.write_coil(channel["write_address"], True)
                    written.add((channel["write_address"], True))
                elif not channel.get("readonly"):
                    self.expect_switch(line, ("coil", channel["address"]), channel["address"])
                    written |= {(channel["address"], True), (channel["address"], False)}
            self.assertEqual(written, coils_to_write(model))

        self.of_each_model(play)


if __name__ == "__main__":
    unittest.main()
