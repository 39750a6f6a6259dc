#!/usr/bin/env python3
"""Checks the hubs for Home Assistant with a schema, and with rules that a schema cannot express."""

import copy
import json
import pathlib
import unittest

import jsonschema
import yaml

from program import describe, models_with_modbus

SCHEMA = json.loads(pathlib.Path(__file__).with_name("home_assistant_modbus.schema.json").read_text(encoding="utf-8"))
OPTIONS = ["--tcp", "--modbus-tcp"]
LISTS = ["switches", "binary_sensors", "sensors"]


def hubs(model, *arguments):
    return yaml.safe_load(describe(model, "--format", "home-assistant", *arguments))


def is_valid(value):
    return jsonschema.Draft7Validator(SCHEMA).is_valid(value)


def entities(hub):
    return [(kind, entity) for kind in LISTS for entity in hub.get(kind, [])]


def with_further_entities(hub):
    """Returns the entities and those that the integration adds for virtual_count: it appends a space and a number to
    the name, and _ and the number to the unique_id."""
    for kind, entity in entities(hub):
        yield kind, entity
        for number in range(1, entity.get("virtual_count", 0) + 1):
            yield kind, entity | {"name": f"{entity['name']} {number}", "unique_id": f"{entity['unique_id']}_{number}"}


def serial_alternative(text):
    """Returns a list with the hub in `text`. The keys in the comment about serial ports replace type, host and port."""
    lines = text.splitlines()
    first = lines.index("#   type: serial")
    last = lines.index("#   stopbits: 1")
    hub = yaml.safe_load(text)[0]
    for key in ["type", "host", "port"]:
        del hub[key]
    return [hub | yaml.safe_load("\n".join(line.removeprefix("#   ") for line in lines[first : last + 1]))]


class HomeAssistant(unittest.TestCase):
    def test_the_schema_is_a_valid_json_schema(self):
        jsonschema.Draft7Validator.check_schema(SCHEMA)

    def test_every_model_that_speaks_modbus_fits_the_schema(self):
        models = models_with_modbus()
        self.assertGreaterEqual(len(models), 5)
        for model in models:
            with self.subTest(model=model):
                for port in [[], ["--modbus-tcp", "192.0.2.7:502"]]:
                    jsonschema.validate(hubs(model, *port), SCHEMA, jsonschema.Draft7Validator)

    def test_the_serial_port_in_the_comment_fits_the_schema(self):
        for model in models_with_modbus():
            with self.subTest(model=model):
                text = describe(model, "--format", "home-assistant")
                jsonschema.validate(serial_alternative(text), SCHEMA, jsonschema.Draft7Validator)

    def test_names_and_ids_are_unique(self):
        for model in models_with_modbus():
            with self.subTest(model=model):
                all_entities = [entity for address in ("01", "02")
                                for entity in with_further_entities(hubs(model, "--address", address)[0])]
                ids = [entity["unique_id"] for _, entity in all_entities]
                names = [(kind, entity["name"]) for kind, entity in all_entities]
                self.assertEqual(len(set(ids)), len(ids))
                self.assertEqual(len(set(names)), len(names))

    def test_the_timeout_is_below_every_interval_and_no_interval_causes_a_warning(self):
        for model in models_with_modbus():
            hub = hubs(model)[0]
            for _, entity in entities(hub):
                self.assertLess(hub["timeout"], entity["scan_interval"])
                self.assertGreaterEqual(entity["scan_interval"], 5)

    def test_address_and_port_are_those_of_the_arguments(self):
        hub = hubs("EX9052D-M", "--address", "2a", "--tcp", "192.0.2.7:4001")[0]
        self.assertEqual((hub["host"], hub["port"], hub["name"]), ("192.0.2.7", 4001, "ex9052d_m_2A"))
        self.assertEqual({entity["slave"] for _, entity in entities(hub)}, {0x2A})

    def test_over_modbus_tcp_only_the_type_of_the_hub_differs(self):
        over_tcp, over_modbus_tcp = (hubs("EX9052D-M", option, "192.0.2.7:502")[0] for option in OPTIONS)
        self.assertEqual((over_tcp.pop("type"), over_modbus_tcp.pop("type")), ("rtuovertcp", "tcp"))
        self.assertEqual(over_tcp, over_modbus_tcp)

    def test_the_schema_rejects_wrong_hubs(self):
        def hub_with(**keys):
            return lambda hub: hub.update(keys)

        def hub_without(key):
            return lambda hub: hub.pop(key)

        def entity_with(kind, **keys):
            return lambda hub: hub[kind][0].update(keys)

        def entity_without(kind, key):
            return lambda hub: hub[kind][0].pop(key)

        outputs, inputs = hubs("EX9042D-M"), hubs("EX9052D-M")
        wrong = [
            (outputs, hub_with(type="rtu")),
            (outputs, hub_with(type="serial")),
            (outputs, hub_with(port="5020")),
            (outputs, hub_with(port=0)),
            (outputs, hub_with(baudrate=9600)),
            (outputs, hub_with(retries=3)),
            (outputs, hub_with(timeout="2")),
            (outputs, hub_with(switches=[])),
            (outputs, hub_with(switch=[])),
            (outputs, hub_without("name")),
            (outputs, hub_without("host")),
            (outputs, lambda hub: [hub.pop(kind, None) for kind in LISTS]),
            (outputs, entity_with("switches", write_type="discrete_input")),
            (outputs, entity_with("switches", verify=True)),
            (outputs, entity_with("switches", verify={"input_type": "discrete"})),
            (outputs, entity_with("switches", input_type="coil")),
            (outputs, entity_with("switches", virtual_count=12)),
            (outputs, entity_with("switches", address=-1)),
            (outputs, entity_with("switches", address="0")),
            (outputs, entity_with("switches", slave="01")),
            (outputs, entity_with("switches", device_address=1)),
            (outputs, entity_with("switches", unique_id=7)),
            (outputs, entity_without("switches", "address")),
            (outputs, entity_without("switches", "name")),
            (inputs, entity_with("binary_sensors", input_type="discrete")),
            (inputs, entity_with("binary_sensors", device_class="input")),
            (inputs, entity_with("binary_sensors", data_type="uint16")),
            (inputs, entity_with("sensors", input_type="coil")),
            (inputs, entity_with("sensors", data_type="u16")),
            (inputs, entity_with("sensors", count=1)),
            (inputs, entity_with("sensors", swap="word")),
            (inputs, entity_with("sensors", scale=0)),
            (inputs, entity_with("sensors", state_class="increasing")),
            (inputs, entity_with("sensors", device_class="duration")),
            (inputs, entity_with("sensors", virtual_count=1, slave_count=1)),
        ]
        for number, (right, change) in enumerate(wrong):
            with self.subTest(number=number):
                changed = copy.deepcopy(right)
                self.assertTrue(is_valid(changed))
                change(changed[0])
                self.assertFalse(is_valid(changed))


if __name__ == "__main__":
    unittest.main()
