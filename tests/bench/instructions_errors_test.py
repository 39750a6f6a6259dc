#!/usr/bin/env python3
"""Tests that tests/bench/instructions reports a missing file, a missing program and a failed emulator in one line. Fake
emulators print an error and end."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

sys.dont_write_bytecode = True  # do not leave byte code in the source tree

from instruction_counts import emulator, pico_emulator  # noqa: E402
from instruction_counts.refusal import Refusal, require_file, require_program  # noqa: E402

PROGRAM = pathlib.Path(__file__).resolve().parent / "instructions"


class Errors(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.programs = self.folder / "programs"
        self.programs.mkdir()

    def images(self, board, *endings):
        folder = self.folder / board
        folder.mkdir()
        for model in "EX9042D-M", "EX9052D-M", "EX9055D":
            for ending in endings:
                (folder / f"{model}.{ending}").write_bytes(b"no image")
        return folder

    def refused(self, *arguments, path=None):
        """Returns the only line that the program prints."""
        finished = subprocess.run([sys.executable, PROGRAM, *arguments], capture_output=True, text=True, check=False,
                                  env={**os.environ, "PATH": path or os.environ["PATH"]})
        self.assertEqual((finished.returncode, finished.stdout), (2, ""), finished.stderr)
        self.assertRegex(finished.stderr, r"\Ainstructions: [^\n]*\n\Z")
        return finished.stderr.removeprefix("instructions: ").rstrip("\n")

    def test_a_missing_image_is_named_with_the_command_that_builds_it(self):
        for board in "lm3s6965evb", "pico":
            folder = self.images(board)
            self.assertEqual(self.refused(folder), f"{folder}/EX9052D-M.elf: No such file or directory; build it with "
                                                   f"`boards/build-images {board}`")

    def test_the_flash_content_of_a_pico_is_required_too(self):
        folder = self.images("pico", "elf")
        self.assertIn(f"{folder}/EX9052D-M.bin: No such file or directory; build it with", self.refused(folder))

    def test_a_missing_plugin_is_named_with_the_command_that_builds_it(self):
        folder = self.images("lm3s6965evb", "elf")
        self.assertEqual(
            self.refused(folder, "--gate", "/nowhere/gate.so"),
            "/nowhere/gate.so: No such file or directory; build it with `cmake --preset host-debug && cmake --build"
            " --preset host-debug --target ex9000_gate`, or name another one with --gate")

    def test_a_missing_program_is_named_with_its_package(self):
        folder = self.images("lm3s6965evb", "elf")
        gate = folder / "EX9055D.elf"  # any file
        self.assertEqual(self.refused(folder, "--gate", gate, path=str(self.programs)),
                         "qemu-system-arm: the program is missing; install the package qemu-system-arm")
        self.assertEqual(self.refused(self.images("pico", "elf", "bin"), path=str(self.programs)),
                         "node: the program is missing; install the package nodejs")

    def test_a_file_that_is_no_image_is_named(self):
        folder = self.images("lm3s6965evb", "elf")
        for name in "qemu-system-arm", "arm-none-eabi-nm":
            self.fake(name, f"echo {name}: x.elf: file format not recognized; exit 1")
        self.assertEqual(
            self.refused(folder, "--gate", folder / "EX9055D.elf", path=f"{self.programs}:{os.environ['PATH']}"),
            "arm-none-eabi-nm: x.elf: file format not recognized; name the ELF file of an image")

    def fake(self, name, commands):
        program = self.programs / name
        program.write_text(f"#!/bin/sh\nexec >&2\n{commands}\n", encoding="utf-8")
        program.chmod(0o755)

    def end_of(self, kind):
        """Returns the error of an emulator that ends at once."""
        with mock.patch.dict(os.environ, {"PATH": f"{self.programs}:{os.environ['PATH']}"}):
            machine = kind(self.folder / "x.elf", self.folder / "gate.so")
            try:
                with self.assertRaises(Refusal) as raised:
                    machine.power_up({})
            finally:
                machine.close()
        return str(raised.exception)

    def test_the_error_of_qemu_is_shown_if_it_ends(self):
        self.fake("qemu-system-arm",
                  "echo qemu-system-arm: warning: no peer; echo qemu: fatal: Lockup; echo R00=0; exit 1")
        self.assertEqual(self.end_of(emulator.Emulator),
                         "qemu-system-arm: the emulator has ended with status 1: qemu: fatal: Lockup; remove the cause"
                         " and start it again")
        self.fake("qemu-system-arm", "kill -KILL $$")
        self.assertEqual(self.end_of(emulator.Emulator),
                         "qemu-system-arm: the emulator has ended with signal 9; remove the cause and start it again")

    def test_the_error_of_node_is_shown_if_it_ends(self):
        self.fake("node", 'echo node:internal/modules; echo "Error: Cannot find module"; echo "    at x"; exit 1')
        self.assertEqual(self.end_of(pico_emulator.PicoEmulator),
                         "node: the emulator has ended with status 1: Error: Cannot find module; remove the cause and"
                         " start it again")

    def test_a_file_and_a_program_that_exist_are_accepted(self):
        require_file(PROGRAM, "")
        require_program("sh", "")


if __name__ == "__main__":
    unittest.main()
