"""Tests the reader of help texts."""

from __future__ import annotations

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "toolchain/release_parts"))

from help_text import Option, UnknownHelp, read  # noqa: E402

TEXT = """A program.
Usage: program [OPTIONS] [THING...] [SUBCOMMAND]

Positionals:
  THING TEXT ...              the things

Options:
  -h,--help                   print help
  --mode fast|N|slow          how fast
  --with 'N WORD' ...         repeats
  --format a|very-long|list-of-formats
                              a text on the next line
  --log [on|off]              a value that may be missing

Subcommands:
  play                        plays
  show                        shows



Notes begin here
  entry   text
"""


class HelpText(unittest.TestCase):
    def test_description_positionals_options_subcommands_and_notes_are_read(self) -> None:
        text = read(TEXT)
        self.assertEqual(text.description, "A program.")
        self.assertEqual(text.positionals, [Option(["THING"], "TEXT", "the things", True)])
        self.assertEqual(
            text.options,
            [
                Option(["-h", "--help"], "", "print help", False),
                Option(["--mode"], "fast|N|slow", "how fast", False),
                Option(["--with"], "'N WORD'", "repeats", True),
                Option(["--format"], "a|very-long|list-of-formats", "a text on the next line", False),
                Option(["--log"], "[on|off]", "a value that may be missing", False),
            ],
        )
        self.assertEqual(text.subcommands, ["play", "show"])
        self.assertEqual(text.notes, ["Notes begin here", "  entry   text"])

    def test_placeholders_are_not_choices(self) -> None:
        choices = [option.choices() for option in read(TEXT).options]
        self.assertEqual(choices, [[], ["fast", "slow"], [], ["a", "very-long", "list-of-formats"], ["on", "off"]])

    def test_an_unknown_form_is_rejected(self) -> None:
        for text in ("", "A program.\nOptions:\n", "A program.\nUsage: program\n"):
            with self.assertRaises(UnknownHelp):
                read(text)
        with self.assertRaisesRegex(UnknownHelp, "'odd' is neither an option"):
            read(TEXT.replace("  -h,--help   ", "   odd\n  -h,--help   "))


if __name__ == "__main__":
    unittest.main()
