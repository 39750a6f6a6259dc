#!/usr/bin/env python3
"""Checks the form of the exports for ESPHome, Home Assistant and wb-mqtt-serial, and of the tables in Markdown and CSV.

answers_test.py checks the addresses in them, and node_red_test.js checks the flows for Node-RED.
"""

import csv
import io
import json
import re
import unittest

import yaml

from program import describe, models_with_modbus, run


def hub_of(model, *options):
    return yaml.safe_load(describe(model, "--format", "home-assistant", *options))[0]


def entities(hub):
    return [(kind, entity) for kind in ["switches", "binary_sensors", "sensors"] for entity in hub.get(kind, [])]


def with_further_entities(hub):
    """Returns the entities and those that the integration adds for virtual_count: it appends a space and a number to
    the name, and _ and the number to the unique_id."""
    for kind, entity in entities(hub):
        yield kind, entity
        for number in range(1, entity.get("virtual_count", 0) + 1):
            yield kind, entity | {"name": f"{entity['name']} {number}", "unique_id": f"{entity['unique_id']}_{number}"}


class HomeAssistant(unittest.TestCase):
    def test_a_hub_has_switches_sensors_and_counters(self):
        hub = hub_of("EX9060D-M", "--address", "2a", "--port", "tcp:192.0.2.7:4001")
        self.assertEqual({key: hub[key] for key in ["name", "type", "host", "port"]},
                         {"name": "ex9060d_m_2A", "type": "rtuovertcp", "host": "192.0.2.7", "port": 4001})
        of = {entity["name"].removeprefix("EX9060D-M 2A "): entity for _, entity in entities(hub)}
        self.assertEqual(of["Output 3"], {
            "name": "EX9060D-M 2A Output 3", "unique_id": "ex9060d_m_2A_output_3", "slave": 0x2A, "address": 3,
            "scan_interval": 5, "write_type": "coil", "verify": {"input_type": "coil", "address": 3}})
        self.assertEqual(of["Counter"], {
            "name": "EX9060D-M 2A Counter", "unique_id": "ex9060d_m_2A_counter", "slave": 0x2A, "address": 0,
            "scan_interval": 5, "virtual_count": 3, "input_type": "input", "data_type": "uint16",
            "state_class": "total_increasing"})
        self.assertEqual(of["Host watchdog timeout status"]["device_class"], "problem")
        self.assertEqual((of["Host watchdog timeout"]["scale"], of["Host watchdog timeout"]["unit_of_measurement"]),
                         (0.1, "s"))

    def test_names_and_ids_are_unique(self):
        for model in models_with_modbus():
            all_entities = [entity for address in ("01", "02")
                            for entity in with_further_entities(hub_of(model, "--address", address))]
            for values in [[entity["unique_id"] for _, entity in all_entities],
                           [(kind, entity["name"]) for kind, entity in all_entities]]:
                self.assertEqual(len(set(values)), len(values), model)

    def test_the_timeout_is_below_every_interval_and_no_interval_causes_a_warning(self):
        for model in models_with_modbus():
            hub = hub_of(model)
            for _, entity in entities(hub):
                self.assertLess(hub["timeout"], entity["scan_interval"])
                self.assertGreaterEqual(entity["scan_interval"], 5)

    def test_over_modbus_tcp_only_the_type_of_the_hub_differs(self):
        over_tcp, over_modbus_tcp = (hub_of("EX9052D-M", "--port", f"{kind}:[fe80::1%eth0]:502")
                                     for kind in ["tcp", "modbus-tcp"])
        self.assertEqual((over_tcp.pop("type"), over_modbus_tcp.pop("type")), ("rtuovertcp", "tcp"))
        self.assertEqual(over_tcp["host"], "fe80::1%eth0")
        self.assertEqual(over_tcp, over_modbus_tcp)

    def test_the_comment_has_the_keys_of_a_serial_port_and_what_a_timeout_means(self):
        for model, after in {"EX9042D-M": "the module refuses to switch the outputs",
                             "EX9052D-M": "the timeout status stays set"}.items():
            text = describe(model, "--format", "home-assistant")
            lines = text.splitlines()
            port = lines[lines.index("#   type: serial"):lines.index("#   stopbits: 1") + 1]
            self.assertEqual(yaml.safe_load("\n".join(line.removeprefix("#   ") for line in port)), {
                "type": "serial", "port": "/dev/ttyUSB0", "baudrate": 9600, "bytesize": 8, "method": "rtu",
                "parity": "N", "stopbits": 1})
            self.assertIn(f"# After a timeout of the host watchdog, {after} until", text)


class NodeRed(unittest.TestCase):
    def test_the_client_has_the_type_and_the_address_of_the_port(self):
        for kind, wanted in {"tcp": "TELNET", "modbus-tcp": "DEFAULT"}.items():
            nodes = json.loads(describe("EX9052D-M", "--format", "node-red", "--port", f"{kind}:192.0.2.7:4001"))
            client = next(node for node in nodes if node["type"] == "modbus-client")
            self.assertEqual((client["tcpType"], client["tcpHost"], client["tcpPort"]), (wanted, "192.0.2.7", "4001"))


class EspHome(unittest.TestCase):
    def test_a_node_has_switches_sensors_and_buttons(self):
        node = yaml.safe_load(describe("EX9060D-M", "--format", "esphome", "--address", "2a"))
        self.assertEqual(node["modbus_controller"], [
            {"id": "ex9060d_m_2A", "modbus_id": node["modbus"]["id"], "address": 0x2A, "update_interval": "5s"}])
        self.assertEqual(node["modbus"]["uart_id"], node["uart"]["id"])
        item = {"platform": "modbus_controller", "modbus_controller_id": "ex9060d_m_2A"}
        self.assertEqual(node["switch"][3], item | {
            "name": "EX9060D-M 2A Output 3", "register_type": "coil", "address": 3})
        self.assertEqual(node["sensor"][3], item | {
            "name": "EX9060D-M 2A Counter 3", "register_type": "read", "address": 3, "value_type": "U_WORD",
            "state_class": "total_increasing"})
        self.assertEqual(node["sensor"][4]["filters"], [{"multiply": 0.1}])
        self.assertIn(item | {"id": "ex9060d_m_2A_clear_latches", "register_type": "coil", "address": 0x0107},
                      node["output"])
        self.assertIn({"platform": "template", "name": "EX9060D-M 2A Clear latches",
                       "on_press": [{"output.turn_on": "ex9060d_m_2A_clear_latches"}]}, node["button"])

    def test_names_are_unique_on_a_platform(self):
        for model in models_with_modbus():
            node = yaml.safe_load(describe(model, "--format", "esphome"))
            for platform in ["switch", "binary_sensor", "sensor", "button"]:
                names = [item["name"] for item in node.get(platform, [])]
                self.assertEqual(len(set(names)), len(names), model)


class WbMqttSerial(unittest.TestCase):
    def test_a_template_has_switches_values_alarms_and_pushbuttons(self):
        template = json.loads(describe("EX9060D-M", "--format", "wb-mqtt-serial"))
        self.assertEqual((template["title"], template["device_type"], template["device"]["id"]),
                         ("EX9060D-M, 4 inputs, 4 relay outputs", "EX9060D-M", "ex9060d_m"))
        of = {channel["name"]: channel for channel in template["device"]["channels"]}
        self.assertEqual(of["Output 3"], {
            "name": "Output 3", "id": "output_3", "reg_type": "coil", "address": 3, "type": "switch"})
        self.assertEqual(of["Power-on value 3"], {
            "name": "Power-on value 3", "id": "power_on_value_3", "reg_type": "coil", "address": 0xA3,
            "type": "switch", "enabled": False, "readonly": True})
        self.assertEqual(of["Counter 3"], {
            "name": "Counter 3", "id": "counter_3", "reg_type": "input", "address": 3, "type": "value",
            "format": "u16", "readonly": True})
        self.assertEqual(of["Clear counter 3"], {
            "name": "Clear counter 3", "id": "clear_counter_3", "reg_type": "coil", "write_address": 0x0203,
            "type": "pushbutton"})
        self.assertEqual(of["Host watchdog timeout"], {
            "name": "Host watchdog timeout", "id": "host_watchdog_timeout", "reg_type": "holding", "address": 0x01E8,
            "type": "value", "format": "u16", "scale": 0.1, "round_to": 0.1, "units": "s", "readonly": True})
        self.assertEqual(of["Host watchdog timeout status"]["type"], "alarm")


class Markdown(unittest.TestCase):
    def test_a_description_of_one_model_has_only_this_model_and_tables_with_rows_of_equal_length(self):
        for model in [line.split()[0] for line in run("--models").splitlines()]:
            text = describe(model)
            self.assertTrue(text.startswith(f"## {model}: "), model)
            self.assertEqual(len(re.findall("^[|] EX", text, re.MULTILINE)), 1)
            self.assertEqual("### Modbus" in text, model in models_with_modbus())
            self.assertNotRegex(text, r" \n|\n\n\n|\|  \||\n\n\Z")
            for table in re.findall(r"(?:^\|.*\|\n)+", text, re.MULTILINE):
                cells = {len(re.findall(r"(?<!\\)\|", row)) for row in table.splitlines()}
                self.assertEqual(len(cells), 1, table)


class Csv(unittest.TestCase):
    def test_every_row_has_all_cells(self):
        rows = list(csv.reader(io.StringIO(describe("--format", "csv")), strict=True))
        titles = "model table address plc_number channel functions command reply access range needs_init id meaning"
        self.assertEqual(rows[0], titles.split())
        self.assertEqual({len(row) for row in rows}, {13})
        # 25 commands, 3 x 13 coils for outputs, 3 other coils and 5 holding registers. The tables of the holding
        # registers and of the input registers both contain the host OK and the extensions: 2 settings, 13 timed
        # outputs, 15 others, 50 of the identity, and 16 of the update, which has 2 more that can only be written
        # (wire.md, extensions.md).
        count = sum(row[0] == "EX9042D-M" for row in rows)
        self.assertEqual(count, 25 + 3 * 13 + 3 + 5 + 2 * (1 + 2 + 13 + 15 + 50 + 16) + 2)

    def test_commands_and_coils_are_rows(self):
        rows = list(csv.reader(io.StringIO(describe("EX9042D-M", "--format", "csv")), strict=True))
        self.assertIn(["EX9042D-M", "DCON command", "", "", "", "", "~AA3EVV", "!AA", "stored",
                       "E: 0 off, 1 on; VV: timeout 01-FF in units of 0.1 s", "no", "set-watchdog",
                       "set the host watchdog"], rows)
        self.assertIn(["EX9042D-M", "coil", "140", "00141", "12", "01 05 0F", "", "", "read, write", "0 off, 1 on", "",
                       "safe-value", "safe value; a write also drives the outputs"], rows)
        self.assertEqual([row[10] for row in rows if row[6] == "$AAPN"], ["yes"])


if __name__ == "__main__":
    unittest.main()
