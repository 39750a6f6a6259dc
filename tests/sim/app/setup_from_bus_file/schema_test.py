#!/usr/bin/env python3
"""Tests that the JSON Schema of bus files and the program agree on keys and on types of values. Uses examples."""

import copy
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import jsonschema

ROOT = pathlib.Path(__file__).resolve().parents[4]
PROGRAM = os.environ.get("EX9000_SIMULATOR", str(ROOT / "build/host-debug/sim/ex9000-sim"))
FILE = "bus.json"

# A valid value of each key, grouped by the path of the object that has the key. The whole file has the empty path.
RIGHT = {
    "": {
        "lines": [{"tcp": 0, "modules": [{"model": "EX9052D-M"}]}],
        "control": "control",
        "panel": 0,
        "watch": True,
        "log": "json",
        "capture": "line.pcapng",
        "seed": 7,
    },
    "lines[0]": {
        "name": "hall",
        "pty": "hall.tty",
        "pty-access": "660:root",
        "tcp": 0,
        "modbus-tcp": 0,
        "serial": "/dev/ttyUSB0",
        "echo": False,
        "baud": 19200,
        "format": "8E1",
        "line": "paced",
        "strict-gaps": True,
        "modbus-timeout": "1s",
        "modules": [{"model": "EX9052D-M"}],
        "faults": ["bit-errors 1e-5"],
    },
    "lines[0].modules[0]": {
        "model": "EX9052D-M",
        "address": "0A",
        "protocol": "ascii",
        "baud": "19200",
        "format": "8O1",
        "checksum": True,
        "edge": "rising",
        "name": "PUMP",
        "init": "off",
        "eeprom": "pump.bin",
        "inputs": ["0 square 100ms"],
        "faults": ["gone at 1h for 2min"],
    },
}
REQUIRED = {"": "lines", "lines[0]": "modules", "lines[0].modules[0]": "model"}
# At least one value of each JSON type. The schema of each key rejects at least three of these values.
OF_EACH_TYPE = [None, True, 5, 1.5, "?", [], {}]


def run(*arguments, folder=None):
    return subprocess.run([PROGRAM, *arguments], cwd=folder, capture_output=True, encoding="utf-8", check=False,
                          timeout=300)  # seconds; only detects a hang


SCHEMA = json.loads(run("--schema").stdout)


def schema_accepts(file):
    return jsonschema.Draft202012Validator(SCHEMA).is_valid(file)


def run_with(file):
    """Runs the program with this bus file. If the file is valid, the program ends after 1 ms."""
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, FILE).write_text(json.dumps(file), encoding="utf-8")
        return run(FILE, "--for", "1ms", folder=folder)


def smallest():
    return {"lines": [{"tcp": 0, "modules": [{"model": "EX9052D-M"}]}]}


def object_at(file, place):
    found = file["lines"][0] if place else file
    return found["modules"][0] if place.endswith("modules[0]") else found


def file_with(place, key, value):
    file = smallest()
    object_at(file, place)[key] = copy.deepcopy(value)
    return file


def keys():
    """Returns for each key: the place of the object that has the key, the key, and a valid value."""
    return [(place, key, value) for place, members in RIGHT.items() for key, value in members.items()]


def path_of(place, key):
    return f"{place}.{key}" if place else key


class BusFileSchema(unittest.TestCase):
    def expect_refused(self, file, path):
        """Expects that the schema and the program reject the file.

        The program must end with status 2 and print only one line, on stderr, in which `path` follows `bus.json:1: `.
        """
        self.assertFalse(schema_accepts(file))
        finished = run_with(file)
        self.assertEqual(finished.returncode, 2, finished.stderr)
        self.assertEqual(finished.stdout, "")
        self.assertEqual(finished.stderr.count("\n"), 1, finished.stderr)
        self.assertRegex(finished.stderr, rf"^ex9000-sim: {FILE}:1: ")
        self.assertIn(f":1: {path}", finished.stderr)

    def test_the_schema_is_a_valid_json_schema(self):
        jsonschema.Draft202012Validator.check_schema(SCHEMA)

    def test_the_schema_accepts_the_example(self):
        self.assertTrue(schema_accepts(json.loads(run("--example").stdout)))

    def test_the_table_of_valid_values_has_every_key_of_the_schema(self):
        for place, properties in (("", SCHEMA), ("lines[0]", SCHEMA["$defs"]["line"]),
                                  ("lines[0].modules[0]", SCHEMA["$defs"]["module"])):
            self.assertEqual(set(RIGHT[place]), set(properties["properties"]), place)

    def test_a_valid_value_of_every_key_is_accepted(self):
        for place, key, value in keys():
            with self.subTest(key=path_of(place, key)):
                file = file_with(place, key, value)
                self.assertTrue(schema_accepts(file))
                # These keys require a serial port that exists, or another key.
                if key not in ("serial", "modbus-timeout", "pty-access"):
                    finished = run_with(file)
                    self.assertEqual(finished.returncode, 0, finished.stderr)

    def test_the_program_rejects_values_that_the_schema_rejects(self):
        for place, key, _ in keys():
            wrong = [value for value in OF_EACH_TYPE if not schema_accepts(file_with(place, key, value))]
            self.assertGreaterEqual(len(wrong), 3, path_of(place, key))
            for value in wrong:
                with self.subTest(key=path_of(place, key), value=value):
                    self.expect_refused(file_with(place, key, value), path_of(place, key))

    def test_an_unknown_key_is_refused(self):
        for place in RIGHT:
            with self.subTest(place=place):
                self.expect_refused(file_with(place, "colour", "red"), path_of(place, "colour") + ": unknown key")

    def test_a_missing_required_key_is_refused(self):
        for place, key in REQUIRED.items():
            with self.subTest(key=path_of(place, key)):
                file = smallest()
                del object_at(file, place)[key]
                self.expect_refused(file, path_of(place, key))

    def test_a_value_of_another_type_in_place_of_an_object_is_refused(self):
        for value in [None, True, 5, "EX9052D-M", []]:
            for file, place in [(value, ""), ({"lines": [value]}, "lines[0]"),
                                ({"lines": [{"modules": [value]}]}, "lines[0].modules[0]")]:
                with self.subTest(place=place, value=value):
                    self.expect_refused(file, f"{place}: expected an object" if place else "expected an object")

    def test_the_published_schema_is_the_schema_that_the_program_prints(self):
        published = ROOT / "sim/docs/bus-file.schema.json"
        self.assertEqual(published.read_text(encoding="utf-8"), run("--schema").stdout,
                         "renew the published schema with toolchain/update-documents")


if __name__ == "__main__":
    unittest.main()
