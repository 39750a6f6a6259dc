"""Reads what `PROGRAM --help` and `PROGRAM SUBCOMMAND --help` print."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

_HEADING = re.compile(r"^(Positionals|Options|Subcommands):$")
_ENTRY = re.compile(r"^  (\S+(?: \S+)*)(?: {2,}(\S.*))?$")
_CONTINUED = re.compile(r"^ {10,}(\S.*)$")
_SUBCOMMAND = re.compile(r"^  ([a-z][a-z-]*) {2,}\S")


class UnknownHelp(Exception):
    """The help text does not have the form that `read` expects."""


@dataclass
class Option:
    """An option or a positional argument."""

    names: list[str]  # for example -h and --help; for a positional argument, its placeholder
    value: str  # placeholder of the value, for example N|max|step; empty if the option has no value
    text: str
    repeats: bool

    def choices(self) -> list[str]:
        """Returns the fixed words that the value can be, without placeholders such as N."""
        if "|" not in self.value:
            return []
        return [word for word in self.value.strip("[]").split("|") if not (word.isalpha() and word.isupper())]


@dataclass
class Help:
    description: str
    usage: str
    positionals: list[Option] = field(default_factory=list)
    options: list[Option] = field(default_factory=list)
    subcommands: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  # the lines after the positionals, options and subcommands


def read(text: str) -> Help:
    """Returns the parts of a help text. Raises UnknownHelp if the text does not have the expected form."""
    lines = text.rstrip().splitlines()
    if len(lines) < 2 or not lines[1].startswith("Usage: "):
        raise UnknownHelp("the help text does not begin with a description and 'Usage:'")
    result = Help(lines[0], lines[1].removeprefix("Usage: "))
    part = ""
    for number, line in enumerate(lines[2:], start=2):
        if heading := _HEADING.match(line):
            part = heading[1]
        elif part == "Subcommands":
            if subcommand := _SUBCOMMAND.match(line):
                result.subcommands.append(subcommand[1])
            elif line and not line.startswith(" "):
                result.notes = lines[number:]
                break
        elif line and not line.startswith(" "):
            result.notes = lines[number:]
            break
        elif line:
            _read_entry(line, result.positionals if part == "Positionals" else result.options)
    if not result.options:
        raise UnknownHelp("the help text lists no options")
    return result


def _read_entry(line: str, entries: list[Option]) -> None:
    if entries and (continued := _CONTINUED.match(line)):
        entries[-1].text = f"{entries[-1].text} {continued[1]}".strip()
    elif match := _ENTRY.match(line):
        words, text = match[1], match[2] or ""
        repeats = words.endswith(" ...")
        names, _, value = words.removesuffix(" ...").removesuffix(" REQUIRED").partition(" ")
        entries.append(Option(names.split(","), value, text, repeats))
    else:
        raise UnknownHelp(f"'{line.strip()}' is neither an option nor an argument nor part of a description")
