#!/usr/bin/env python3
"""Tests that the JSON Schema of bus files and the program agree on keys and on the form of their values."""

import copy
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import jsonschema
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[4]
PROGRAM = os.environ.get("EX9000_SIMULATOR", str(ROOT / "build/host-debug/sim/ex9000-sim"))
FILE = "bus.yaml"

# Valid values of each key, grouped by the object that has the key.
RIGHT = {
    "run": {
        "lines": [[{"port": "tcp:0", "modules": ["EX9052D-M"]}]],
        "control": ["control"],
        "panel": [0, "0", False, "off"],
        "log": ["json", True, "off"],
        "capture": ["line.pcapng"],
        "seed": [7, "7"],
        "speed": [1.5, "10"],
        "for": ["1ms"],
    },
    "line": {
        "name": ["hall"],
        "port": ["tcp:0", ["tcp:0", "pty:hall.tty,access=660"]],
        "baud": [19200, "19200"],
        "format": ["8E1"],
        "timing": ["paced"],
        "strict-gaps": [True, "off"],
        "modules": [["EX9052D-M"], [{"model": "EX9052D-M"}]],
        "fault": ["bit-errors 1e-5", []],
    },
    "module": {
        "model": ["EX9052D-M"],
        "address": ["0A", 10],
        "protocol": ["ascii"],
        "baud": ["19200"],
        "format": ["8O1"],
        "checksum": [True],
        "edge": ["rising"],
        "name": ["PUMP", 42],
        "init": ["off"],
        "eeprom": ["pump.bin"],
        "input": [["0 square 100ms"]],
        "fault": ["gone at 1h for 2min"],
    },
}
REQUIRED = {"run": "lines", "line": "modules", "module": "model"}


def run(*arguments, folder=None):
    return subprocess.run([PROGRAM, *arguments], cwd=folder, capture_output=True, encoding="utf-8", check=False,
                          timeout=300)  # seconds; only detects a hang


SCHEMA = json.loads(run("--schema").stdout)
PROPERTIES = {
    "run": SCHEMA["properties"],
    "line": SCHEMA["$defs"]["line"]["properties"],
    "module": SCHEMA["$defs"]["module"]["anyOf"][1]["properties"],
}


def schema_accepts(file):
    return jsonschema.Draft202012Validator(SCHEMA).is_valid(file)


def run_with(file):
    """Runs the program with this bus file. If the file is valid, the program ends after 1 ms."""
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, FILE).write_text(json.dumps(file), encoding="utf-8")
        return run(FILE, "--for", "1ms", folder=folder)


def file_with(place, change):
    file = {"lines": [{"port": "tcp:0", "modules": [{"model": "EX9052D-M"}]}]}
    objects = {"run": file, "line": file["lines"][0], "module": file["lines"][0]["modules"][0]}
    change(objects[place])
    return file


def file_of(place, key, value):
    return file_with(place, lambda members: members.update({key: copy.deepcopy(value)}))


class BusFileSchema(unittest.TestCase):
    def expect_refused(self, file, key):
        """Expects that the schema and the program reject the file, the latter with status 2 and one line on stderr."""
        self.assertFalse(schema_accepts(file))
        finished = run_with(file)
        self.assertEqual(finished.returncode, 2, finished.stderr)
        self.assertEqual(finished.stdout, "")
        self.assertRegex(finished.stderr, rf"\Aex9000-sim: {FILE}:1: {key}[^\n]*\n\Z")

    def test_the_schema_is_valid_and_accepts_the_example(self):
        jsonschema.Draft202012Validator.check_schema(SCHEMA)
        self.assertTrue(schema_accepts(yaml.safe_load(run("--example").stdout)))

    def test_the_schema_describes_each_key(self):
        for place, keys in RIGHT.items():
            self.assertLessEqual(set(keys), set(PROPERTIES[place]), place)
            for key, form in PROPERTIES[place].items():
                self.assertTrue(form["description"], key)

    def test_valid_values_are_accepted(self):
        for place, keys in RIGHT.items():
            for key, values in keys.items():
                for value in values:
                    with self.subTest(key=key, value=value):
                        self.assertTrue(schema_accepts(file_of(place, key, value)))
                        finished = run_with(file_of(place, key, value))
                        self.assertEqual(finished.returncode, 0, finished.stderr)

    def test_a_value_of_the_wrong_form_is_refused(self):
        for place, keys in RIGHT.items():
            for key in keys:
                for value in [None, {}, [[]]] if key in ("port", "fault", "input") else [None, {}, []]:
                    with self.subTest(key=key, value=value):
                        self.expect_refused(file_of(place, key, value), "")

    def test_an_unknown_key_and_a_missing_key_are_refused(self):
        for place, key in REQUIRED.items():
            self.expect_refused(file_of(place, "colour", "red"), "colour: unknown key")
            self.expect_refused(file_with(place, lambda members, key=key: members.pop(key)), f"{key}: ")

    def test_the_published_schema_is_the_schema_that_the_program_prints(self):
        published = ROOT / "sim/docs/bus-file.schema.json"
        self.assertEqual(published.read_text(encoding="utf-8"), run("--schema").stdout,
                         "renew the published schema with toolchain/update-documents")


if __name__ == "__main__":
    unittest.main()
