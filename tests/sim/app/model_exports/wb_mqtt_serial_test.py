#!/usr/bin/env python3
"""Checks the device templates for wb-mqtt-serial with a schema, and with rules that a schema cannot express."""

import copy
import json
import pathlib
import unittest

import jsonschema

from program import describe, models_with_modbus

SCHEMA = json.loads(pathlib.Path(__file__).with_name("wb_mqtt_serial_template.schema.json").read_text(encoding="utf-8"))


def template(model):
    return json.loads(describe(model, "--format", "wb-mqtt-serial"))


def is_valid(value):
    return jsonschema.Draft7Validator(SCHEMA).is_valid(value)


class WbMqttSerial(unittest.TestCase):
    def test_the_schema_is_a_valid_json_schema(self):
        jsonschema.Draft7Validator.check_schema(SCHEMA)

    def test_every_model_that_speaks_modbus_fits_the_schema(self):
        models = models_with_modbus()
        self.assertGreaterEqual(len(models), 5)
        for model in models:
            with self.subTest(model=model):
                jsonschema.validate(template(model), SCHEMA, jsonschema.Draft7Validator)

    def test_names_and_ids_are_unique(self):
        for model in models_with_modbus():
            channels = template(model)["device"]["channels"]
            for key in ["name", "id"]:
                values = [channel[key] for channel in channels]
                self.assertEqual(len(set(values)), len(values), model)

    def test_the_schema_rejects_wrong_templates(self):
        right = template("EX9052D-M")
        of = {channel["id"]: number for number, channel in enumerate(right["device"]["channels"])}

        def with_keys(**keys):
            return lambda template: template.update(keys)

        def device_with(**keys):
            return lambda template: template["device"].update(keys)

        def channel_with(channel_id, **keys):
            return lambda template: template["device"]["channels"][of[channel_id]].update(keys)

        def channel_without(channel_id, key):
            return lambda template: template["device"]["channels"][of[channel_id]].pop(key)

        wrong = [
            with_keys(group="relays"),
            with_keys(devices=[]),
            lambda template: template.pop("device_type"),
            device_with(id="ex/9052"),
            device_with(channels=[]),
            device_with(max_read_registers="8"),
            device_with(slave=1),
            channel_with("inputs_0", reg_type="discrete_input"),
            channel_with("inputs_0", readonly=False),
            channel_with("inputs_0", format="u16"),
            channel_with("inputs_0", name="Input #0"),
            channel_without("inputs_0", "address"),
            channel_without("inputs_0", "readonly"),
            channel_without("inputs_0", "name"),
            channel_with("counters_0", format="uint16"),
            channel_with("counters_0", address="zero"),
            channel_with("counters_0", type="counter"),
            channel_without("clear_latches", "write_address"),
        ]
        self.assertTrue(is_valid(right))
        for number, change in enumerate(wrong):
            with self.subTest(number=number):
                changed = copy.deepcopy(right)
                change(changed)
                self.assertFalse(is_valid(changed))


if __name__ == "__main__":
    unittest.main()
