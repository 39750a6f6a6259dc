#!/usr/bin/env python3
"""Tests that the rig of two Picos in sim/docs/verify.md verifies a module. All modules are simulated."""

import contextlib
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from wired_ex9000 import Simulator

FOLDER = pathlib.Path(__file__).resolve().parent
ROOT = FOLDER.parents[2]
SIMULATOR = os.environ.get("EX9000_SIMULATOR", str(ROOT / "build/host-debug/sim/ex9000-sim"))
UTILITY = str(pathlib.Path(SIMULATOR).with_name("ex9000"))
HANG = 600  # seconds


def printed(pattern):
    """Returns what the document shows: the only text that the group of the pattern matches."""
    text = (ROOT / "sim/docs/verify.md").read_text(encoding="utf-8")
    [found] = re.findall(pattern, text, re.MULTILINE | re.DOTALL)
    return found


@contextlib.contextmanager
def simulator(folder, name, *modules):
    """Runs a simulator with the port NAME.tty and the control socket NAME.ctl in the folder."""
    command = [SIMULATOR, *modules, "--port", f"pty:{name}.tty", "--control", f"{name}.ctl"]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, encoding="utf-8") as program:
        try:
            greeting = ""
            while not greeting.endswith("press Ctrl-C to end\n"):
                line = program.stdout.readline()
                if not line:
                    raise ConnectionError(f"the simulator has ended: {greeting}")
                greeting += line
            with Simulator(os.path.join(folder, f"{name}.ctl")) as control:
                yield control
        finally:
            program.terminate()


class TwoPicos(unittest.TestCase):
    def passes(self, model, settings, transcripts):
        rig_modules = printed(r"^ex9000-sim (EX9043\S+ EX9053\S+)\n").split()
        with tempfile.TemporaryDirectory() as folder, \
                simulator(folder, "rig", *rig_modules), simulator(folder, "module", model + settings) as module:
            rig = pathlib.Path(folder, "rig")
            rig.write_text(printed(r"^cat >rig <<'END'\n(.*?)^END\n"), encoding="utf-8")
            rig.chmod(0o755)
            pathlib.Path(folder, "ex9000").symlink_to(FOLDER / "wired_ex9000.py")
            environment = os.environ | {"PATH": f"{folder}:{os.environ['PATH']}", "EX9000_UTILITY": UTILITY}
            before = module.tell("1 status")
            files = [ROOT / "tests/conformance" / transcript for transcript in transcripts]
            finished = subprocess.run(
                [UTILITY, "verify", "module.tty", "5", *files, "--model", model, "--rig", "./rig rig.tty"],
                cwd=folder, env=environment, capture_output=True, encoding="utf-8", check=False, timeout=HANG)
            runs = len(transcripts)
            self.assertRegex(finished.stdout, rf"\nsettings restored\n{runs} runs, [0-9]+ steps: {runs} passed, "
                                              r"0 failed, 0 not verified\n\Z")
            self.assertEqual((finished.returncode, finished.stderr), (0, ""))
            self.assertEqual(module.tell("1 status"), before)

    def test_they_drive_supply_init_and_inputs(self):
        self.passes("EX9052D-M", "@05,protocol=ascii,baud=19200,edge=rising,name=PUMP",
                    ["dcon/init/replies-carry-00-inputs.txt", "modbus/inputs/level-while-off.txt"])

    def test_they_see_outputs(self):
        self.passes("EX9042D-M", "@05,checksum=on",
                    ["dcon/init/works-like-normal.txt", "modbus/requests/coils-across-bytes.txt"])


if __name__ == "__main__":
    unittest.main()
