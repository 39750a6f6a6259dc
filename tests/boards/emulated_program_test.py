"""Tests when the programs boards/*/run show the pseudo-terminal, with a machine that does nothing."""

from __future__ import annotations

import argparse
import contextlib
import io
import pathlib
import signal
import sys
import tempfile
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "boards"))

from emulated import program  # noqa: E402 # pylint: disable=wrong-import-position


class IdleMachine:
    """Ends the program at the first call of `carry`."""

    watched: list[int] = []
    carry_within = 0.0

    def __init__(self, link: pathlib.Path) -> None:
        self.link = link
        self.was_linked_at_start = link.is_symlink()
        self.was_linked_at_carry = False

    def carry(self, _requests: bytes, _ready: list[int]) -> bytes:
        self.was_linked_at_carry = self.link.is_symlink()
        raise program.Ended("the test is over")

    def end(self) -> None:
        pass


class Run(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.link = pathlib.Path(folder.name) / "tty"
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            self.addCleanup(signal.signal, number, signal.getsignal(number))
        self.addCleanup(signal.set_wakeup_fd, -1)
        self.output = io.StringIO()
        self.machines: list[IdleMachine] = []

    def run_program(self) -> int:
        def start() -> IdleMachine:
            self.assertEqual(self.output.getvalue(), "")
            self.machines.append(IdleMachine(self.link))
            return self.machines[0]

        arguments = argparse.Namespace(image=pathlib.Path("image.elf"), link=self.link)
        with contextlib.redirect_stdout(self.output), contextlib.redirect_stderr(io.StringIO()):
            return program.run(arguments, "a test", start)

    def test_the_link_exists_only_while_the_module_listens(self) -> None:
        self.assertEqual(self.run_program(), 1)
        self.assertFalse(self.machines[0].was_linked_at_start)
        self.assertTrue(self.machines[0].was_linked_at_carry)
        self.assertFalse(self.link.is_symlink())


if __name__ == "__main__":
    unittest.main()
