#!/usr/bin/env python3
"""Tests the program ex9000 as a process, on the ports of a simulator."""

import os
import pathlib
import re
import signal
import subprocess
import tempfile
import unittest

SIMULATOR = os.environ.get(
    "EX9000_SIMULATOR", str(pathlib.Path(__file__).resolve().parents[3] / "build/host-debug/sim/ex9000-sim"))
UTILITY = str(pathlib.Path(SIMULATOR).with_name("ex9000"))
HANG = 60  # seconds
READ_NAME = "01 11"
HAS_REPLIED = re.compile(r"^< 01 11 .*Report Server ID", re.MULTILINE)


class Ports(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        self.simulator = subprocess.Popen(
            [SIMULATOR, "EX9052D-M@01", "--port", "pty:line.tty", "--port", "tcp:0", "--port", "modbus-tcp:0"],
            cwd=folder, stdout=subprocess.PIPE, encoding="utf-8")
        self.addCleanup(self.simulator.stdout.close)
        self.addCleanup(self.simulator.wait)
        self.addCleanup(self.simulator.kill)
        greeting = ""
        while not greeting.endswith("press Ctrl-C to end\n"):
            greeting += self.simulator.stdout.readline()
        self.tty = os.path.join(folder, "line.tty")
        self.tcp, self.modbus_tcp = (
            f"{kind}:127.0.0.1:{number}" for kind, number in zip(
                ("tcp", "modbus-tcp"), re.findall(r"127\.0\.0\.1:(\d+)", greeting)))

    def run_utility(self, *words):
        return subprocess.run([UTILITY, *words], capture_output=True, encoding="utf-8", timeout=HANG, check=False)

    def poll(self, port):
        """Returns the running program after its first line."""
        program = subprocess.Popen(  # pylint: disable=consider-using-with
            [UTILITY, "poll", port, "1", "--every", "10ms", "--timeout", "10s"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8")
        for at_the_end in (program.stdout.close, program.stderr.close, program.wait, program.kill):
            self.addCleanup(at_the_end)
        self.assertTrue(program.stdout.readline().startswith("inputs 00 "))
        return program

    def test_each_port_carries_requests(self):
        for port in (self.tty, self.tcp, self.modbus_tcp):
            with self.subTest(port=port):
                finished = self.run_utility("send", port, READ_NAME)
                self.assertRegex(finished.stdout, HAS_REPLIED)
                self.assertEqual(finished.returncode, 0)
                shown = self.run_utility("show", port, "1", "--timeout", "10s")
                self.assertIn("EX9052D-M '9052M'", shown.stdout)
                self.assertEqual(shown.returncode, 0)

    def test_a_gateway_tells_that_a_module_gives_no_reply(self):
        finished = self.run_utility("send", self.modbus_tcp, "09 11")
        self.assertEqual((finished.returncode, finished.stderr), (1, "ex9000: no reply\n"))

    def test_ctrl_c_ends_it(self):
        program = self.poll(self.tty)
        program.send_signal(signal.SIGINT)
        self.assertEqual(program.wait(HANG), 130)

    def test_it_says_that_the_line_is_gone(self):
        program = self.poll(self.tcp)
        self.simulator.kill()
        self.assertEqual(program.wait(HANG), 1)
        self.assertRegex(program.stderr.read(), r"ex9000: tcp:\S+: (the other side has closed|.*; connect it again)")

    def test_it_ends_when_nobody_reads_what_it_prints(self):
        program = self.poll(self.tty)
        program.stdout.close()
        self.assertEqual(program.wait(HANG), 1)
        self.assertIn("standard output: cannot be written", program.stderr.read())

    def test_wrong_arguments_and_ports_are_refused(self):
        for words, status, problem in (
                (("show", "/dev/null", "1"), 2, "/dev/null: is not a serial port"),
                (("show", "/dev/missing", "1"), 1, "/dev/missing: "),
                (("show", "tcp:127.0.0.1:1", "1"), 1, "tcp:127.0.0.1:1: Connection refused; name a host"),
                (("show", "tcp:127.0.0.1", "1"), 2, "'tcp:127.0.0.1': expected tcp:HOST:PORT"),
                (("panel", self.modbus_tcp), 2, "Modbus TCP shows no frames of the line"),
                (("address", self.tcp, "0D000001", "248"), 2, "'248': expected an address from 1 to 247"),
                (("show", self.tcp, "1", "--speed"), 2, "--speed"),
                (("dance",), 2, "")):
            with self.subTest(words=words):
                finished = self.run_utility(*words)
                self.assertEqual(finished.returncode, status, finished.stderr)
                self.assertIn(problem, finished.stderr)
                self.assertTrue(finished.stderr.startswith("ex9000: "), finished.stderr)

    def test_it_tells_its_version_and_its_commands(self):
        self.assertEqual(self.run_utility("--version").stdout, "ex9000 D01.00\n")
        self.assertIn("\nSubcommands:\n  scan ", self.run_utility("--help").stdout)
        self.assertIn("  response-delay=MS ", self.run_utility("set", "--help").stdout)


if __name__ == "__main__":
    unittest.main()
