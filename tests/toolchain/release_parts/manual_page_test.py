"""Tests the manual page of the built program."""

from __future__ import annotations

import re
import shutil
import subprocess
import unittest

from parts import PROGRAM, UTILITY, printed, written
from help_text import read


class ManualPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.page = written("manual-page", str(PROGRAM))

    def test_the_page_has_every_subcommand_and_the_options_of_the_program_and_of_describe(self) -> None:
        helps = read(printed("--help"))
        for option in [*helps.options, *read(printed("describe", "--help")).options]:
            for name in option.names:
                self.assertIn("Fl " + name[1:].replace("-", "\\-"), self.page)
        self.assertGreaterEqual(len(helps.subcommands), 2)
        for name in helps.subcommands:
            self.assertIn(f"\n.Ss {name}\n", self.page)

    def test_the_date_of_the_page_is_the_date_of_the_release(self) -> None:
        self.assertTrue(self.page.startswith(".Dd September 21, 2026\n"))

    @unittest.skipUnless(shutil.which("mandoc"), "mandoc is not installed")
    def test_mandoc_reports_no_problem(self) -> None:
        for page in (self.page, written("manual-page", str(UTILITY))):
            done = subprocess.run(["mandoc", "-Tlint"], input=page, capture_output=True, text=True, check=False)
            self.assertEqual((done.stdout, done.stderr, done.returncode), ("", "", 0))

    def test_the_page_of_the_utility_has_its_settings(self) -> None:
        page = written("manual-page", str(UTILITY))
        self.assertIn(".Nm ex9000\n", page)
        self.assertIn('.It Li "name=TEXT"', page)

    @unittest.skipUnless(shutil.which("mandoc"), "mandoc is not installed")
    def test_a_reader_sees_every_word_of_the_help_except_headings_and_notation(self) -> None:
        command = ["mandoc", "-Tascii", "-Owidth=200"]
        done = subprocess.run(command, input=self.page, capture_output=True, text=True, check=True)
        shown = re.sub(".\b", "", done.stdout)  # bold: `x`, backspace, `x`; underlined: `_`, backspace, `x`
        only_in_help = {"-h,--help", "[MODULE...]", "[SUBCOMMAND]", "REQUIRED", "TEXT", "Usage:"}
        only_in_help |= {"Positionals:", "Options:", "Subcommands:", "Examples:"}
        missing = {word for word in printed("--help").split() if word.lower() not in shown.lower()}
        self.assertEqual(missing - only_in_help, set())


if __name__ == "__main__":
    unittest.main()
