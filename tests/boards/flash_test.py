"""Tests toolchain/flash, as far as possible without a board."""

from __future__ import annotations

import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
IMAGE = "/some where/EX9042D-M.elf"
HANG = 60  # seconds; OpenOCD takes less than one second, or a few seconds on a busy machine

MOVES_A_BOARD = ("init", "reset", "flash", "verify_image", "poll")
ECHO_INSTEAD = "; ".join([f'proc {name} {{args}} {{ echo "> {name} $args" }}' for name in MOVES_A_BOARD])


def openocd_script(board: Path) -> str | None:
    """Returns the OpenOCD script that the file `board` names. If `board` names no script but includes a file, returns
    the script that the included file names. Returns None if there is no script."""
    text = board.read_text()
    if match := re.search(r"set\(openocd_script (\S+)\)", text):
        return match.group(1).replace("${CMAKE_CURRENT_LIST_DIR}", str(board.parent))
    if match := re.search(r"include\(\${CMAKE_CURRENT_LIST_DIR}/(\S+)\)", text):
        return openocd_script((board.parent / match.group(1)).resolve())
    return None


def openocd_scripts() -> dict[str, str]:
    """Returns the OpenOCD script of each board that can be flashed."""
    scripts = {file.parent.name: openocd_script(file) for file in sorted(ROOT.glob("boards/*/board.cmake"))}
    return {board: script for board, script in scripts.items() if script is not None}


def flash(script: str, *, path: str) -> subprocess.CompletedProcess[str]:
    words = ["/bin/sh", str(ROOT / "toolchain/flash"), script, IMAGE]
    return subprocess.run(words, env={"PATH": path}, capture_output=True, text=True, timeout=HANG, check=False)


def openocd_words(script: str) -> list[str]:
    """Returns the arguments with which toolchain/flash calls OpenOCD."""
    with tempfile.TemporaryDirectory() as directory:
        program = Path(directory, "openocd")
        program.write_text("#!/bin/sh\nprintf '%s\\n' \"$@\"\n")
        program.chmod(0o755)
        finished = flash(script, path=directory)
        assert finished.returncode == 0, finished.stderr
        return finished.stdout.splitlines()


def openocd(words: list[str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["openocd", *words], capture_output=True, text=True, timeout=HANG, check=False)


class Flash(unittest.TestCase):
    def test_every_board_has_a_script_that_openocd_understands(self) -> None:
        self.assertEqual(set(openocd_scripts()), {"ek-tm4c123gxl", "lm3s6965evb", "pico", "pico-relay-b", "pico-w"})
        for board, script in openocd_scripts().items():
            with self.subTest(board):
                finished = openocd(["-f", script, "-c", "noinit", "-c", "shutdown"])
                self.assertEqual(finished.returncode, 0, finished.stderr)

    def test_openocd_resets_writes_verifies_and_resets_in_this_order(self) -> None:
        for board, script in openocd_scripts().items():
            with self.subTest(board):
                words = openocd_words(script)
                finished = openocd([*words[:2], "-c", "noinit", "-c", ECHO_INSTEAD, *words[2:]])
                self.assertEqual(finished.returncode, 0, finished.stderr)
                self.assertEqual(
                    [line[2:].strip() for line in finished.stderr.splitlines() if line.startswith("> ")],
                    [
                        "init",
                        "reset init",
                        f"flash write_image erase {{{IMAGE}}}",
                        f"verify_image {{{IMAGE}}}",
                        "poll off",
                        "reset run",
                    ],
                )

    def test_the_error_of_a_failure_says_what_to_check(self) -> None:
        with tempfile.TemporaryDirectory() as directory:
            program = Path(directory, "openocd")
            program.write_text("#!/bin/sh\nexit 1\n")
            program.chmod(0o755)
            finished = flash("board/any.cfg", path=directory)
        self.assertEqual(finished.returncode, 1)
        self.assertRegex(
            finished.stderr,
            rf"^flash: {IMAGE}: OpenOCD could not write or verify the image; connect the debugger .*\n$",
        )

    def test_the_error_of_a_missing_openocd_names_the_package(self) -> None:
        finished = flash("board/any.cfg", path="/nowhere")
        self.assertEqual(finished.returncode, 1)
        self.assertEqual(finished.stderr, "flash: openocd is missing; install the package openocd\n")


if __name__ == "__main__":
    unittest.main()
