#!/usr/bin/env python3
"""Tests what the rig of two Picos in sim/docs/verify.md does for each request. Its modules are simulated."""

import os
import pathlib
import re
import socket
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
SIMULATOR = os.environ.get("EX9000_SIMULATOR", str(ROOT / "build/host-debug/sim/ex9000-sim"))


def printed(pattern):
    """Returns what the document shows: the only text that the group of the pattern matches."""
    text = (ROOT / "sim/docs/verify.md").read_text(encoding="utf-8")
    [found] = re.findall(pattern, text, re.MULTILINE | re.DOTALL)
    return found


class TwoPicos(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        modules = printed(r"^ex9000-sim (EX9043\S+ EX9053\S+)\n").split()
        simulator = self.start([SIMULATOR, *modules, "--port", "pty:rig.tty", "--control", "rig.ctl"], folder)
        while not simulator.stdout.readline().startswith("press Ctrl-C"):
            pass
        control = self.enterContext(socket.socket(socket.AF_UNIX))
        control.connect(os.path.join(folder, "rig.ctl"))
        self.control = control
        self.answers = self.enterContext(control.makefile(encoding="utf-8"))
        script = pathlib.Path(folder, "rig")
        script.write_text(printed(r"^cat >rig <<'END'\n(.*?)^END\n"), encoding="utf-8")
        script.chmod(0o755)
        path = f"{pathlib.Path(SIMULATOR).parent}:{os.environ['PATH']}"
        self.rig = self.start(["./rig", "rig.tty"], folder, os.environ | {"PATH": path})

    def start(self, command, folder, environment=None):
        program = subprocess.Popen(command, cwd=folder, env=environment, stdin=subprocess.PIPE,
                                   stdout=subprocess.PIPE, encoding="utf-8")
        for at_the_end in (program.stdin.close, program.stdout.close, program.wait, program.kill):
            self.addCleanup(at_the_end)
        return program

    def ask(self, request):
        self.rig.stdin.write(f"{request}\n")
        self.rig.stdin.flush()
        return self.rig.stdout.readline().rstrip("\n")

    def tell(self, command):
        self.control.sendall(f"{command}\n".encode())
        return self.answers.readline().rstrip("\n")

    def test_they_drive_supply_init_and_inputs(self):
        self.assertEqual(self.tell("1 outputs"), "ok 0000")
        for request, outputs in (("power on", "0100"), ("init on", "0300"), ("input 0 on", "0301"),
                                 ("input 7 on", "0381"), ("input 0 off", "0380"), ("power off", "0280"),
                                 ("init off", "0080"), ("pulse 7 x2", "0080"), ("pulse 3 x1", "0080")):
            with self.subTest(request=request):
                self.assertEqual(self.ask(request), "ok")
                self.assertEqual(self.tell("1 outputs"), f"ok {outputs}")

    def test_they_see_outputs(self):
        for channel in (0, 9, 15):
            self.tell(f"2 input {channel} on")
        self.assertEqual(self.ask("outputs"), "ok 8201")

    def test_the_rig_says_what_it_cannot_do(self):
        for request in ("reset", "led", "input 8 on", "pulse 0 x200", "power cycle", ""):
            self.assertEqual(self.ask(request), "cannot")

    def test_the_rig_reports_modules_that_do_not_reply(self):
        self.tell("1 power off")
        self.assertEqual(self.ask("power on"), "error: ex9000: no reply")


if __name__ == "__main__":
    unittest.main()
