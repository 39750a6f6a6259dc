"""Tests the completions for bash and zsh that are generated from the built program."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import unittest

from parts import PROGRAM, UTILITY, printed, written

_COMPLETE = """
cd "$1"
source "$2"
shift 2
COMP_WORDS=("$@")
COMP_CWORD=$(($# - 1))
"_$(basename "$1" | tr - _)"
printf '%s\\n' "${COMPREPLY[@]}"
"""


class Bash(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.script = written("bash-completion", str(PROGRAM))

    def complete(self, *words: str, name: str = "ex9000-sim", script_of: str = "") -> list[str]:
        """Returns the completions of the last of `words`. The current folder contains one file, bus.json."""
        with tempfile.TemporaryDirectory() as folder, tempfile.NamedTemporaryFile("w") as script:
            open(f"{folder}/bus.json", "w", encoding="utf-8").close()
            script.write(script_of or self.script)
            script.flush()
            command = ["bash", "-c", _COMPLETE, "bash", folder, script.name, name, *words]
            return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()

    def test_options_of_the_program_and_of_a_subcommand_are_completed(self) -> None:
        self.assertEqual(self.complete("--c"), ["--capture", "--control"])
        self.assertEqual(self.complete("describe", "EX9042D-M", "--f"), ["--format"])

    def test_models_subcommands_and_bus_files_are_completed(self) -> None:
        models = [line.split()[0] for line in printed("--models").splitlines()]
        self.assertEqual(self.complete(""), ["play", "describe", "help", *models])
        self.assertEqual(self.complete("describe", "EX9042"), ["EX9042D", "EX9042D-M"])
        self.assertEqual(self.complete("bus"), ["bus.json"])
        self.assertEqual(self.complete("play", "b"), ["bus.json"])

    def test_the_utility_has_its_own(self) -> None:
        script = written("bash-completion", str(UTILITY))
        self.assertEqual(self.complete("sa", name="ex9000", script_of=script), ["save"])
        self.assertEqual(self.complete("update", "b", name="ex9000", script_of=script), ["bus.json"])
        self.assertEqual(self.complete("set", "--format", "8E", name="ex9000", script_of=script), ["8E1"])

    def test_values_of_options_are_completed(self) -> None:
        self.assertEqual(self.complete("EX9042D", "--timing", ""), ["paced", "instant"])
        self.assertEqual(self.complete("EX9042D", "--log", "j"), ["json"])
        self.assertEqual(self.complete("EX9042D", "--log", "EX9052"), ["EX9052D", "EX9052D-M"])
        self.assertEqual(self.complete("EX9042D", "--capture", "b"), ["bus.json"])
        self.assertIn("19200", self.complete("EX9042D", "--baud", ""))
        self.assertIn("home-assistant", self.complete("describe", "EX9042D-M", "--format", ""))

    @unittest.skipUnless(shutil.which("shellcheck"), "shellcheck is not installed")
    def test_shellcheck_reports_no_problem(self) -> None:
        command = ["shellcheck", "-s", "bash", "-"]
        done = subprocess.run(command, input=self.script, capture_output=True, text=True, check=False)
        self.assertEqual(done.stdout, "")


class Zsh(unittest.TestCase):
    def test_the_script_names_the_program_and_an_option(self) -> None:
        script = written("zsh-completion", str(PROGRAM))
        self.assertTrue(script.startswith("#compdef ex9000-sim\n"))
        self.assertIn("--port[", script)

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh_finds_no_syntax_error(self) -> None:
        script = written("zsh-completion", str(PROGRAM))
        done = subprocess.run(["zsh", "-n", "/dev/stdin"], input=script, capture_output=True, text=True, check=False)
        self.assertEqual((done.stderr, done.returncode), ("", 0))


if __name__ == "__main__":
    unittest.main()
