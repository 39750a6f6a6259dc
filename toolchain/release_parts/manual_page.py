"""Writes the manual page of a program, in the language mdoc, from its help texts."""

from __future__ import annotations

import datetime
import re
from dataclasses import dataclass

from help_text import Help, Option

# A list entry of the notes: two spaces, the term, two or more spaces, the description.
_ENTRY = re.compile(r"^  (\S+(?: \S+)*) {2,}(\S.*)$")
_CONTINUED = re.compile(r"^ {10,}(\S.*)$")

# Without these escapes, a backslash begins an escape, a quotation mark ends an argument of a macro, and the page shows
# typographic characters instead of -, ' and `. A shell does not understand these typographic characters. The backslash
# is the first key, because the other escapes contain it.
_ESCAPES = {"\\": "\\e", '"': "\\(dq", "-": "\\-", "'": "\\(aq", "`": "\\(ga"}


def manual_page(
    name: str, program: Help, subcommands: dict[str, Help], topics: dict[str, str], released: datetime.date
) -> str:
    """Returns the page. `topics` are the texts of `help`; `released` is the date that the page shows."""
    page = _PAGES[name]
    lines = [
        f".Dd {released.strftime('%B')} {released.day}, {released.year}",
        f".Dt {name.upper()} 1",
        ".Os",
        ".Sh NAME",
        f".Nm {name}",
        f".Nd {page.title}",
        ".Sh SYNOPSIS",
        *_synopsis(program),
    ]
    for command, help_of in subcommands.items():
        lines += [".Nm", f".Cm {command}", *_usage(help_of)]
    lines += [".Sh DESCRIPTION", *_prose(program.description)]
    lines += [".Sh OPTIONS", *_options(program)]
    _, examples = _without_examples(program.notes)
    lines += [".Sh COMMANDS"]
    for command, help_of in subcommands.items():
        its_notes, its_examples = _without_examples(help_of.notes)
        examples += its_examples
        lines += [f".Ss {command}", *_prose(_sentence(help_of.description)), *_options(help_of), *_notes(its_notes)]
    for topic, text in topics.items():
        lines += [f".Sh {topic.upper()}", *_first(_notes(text.splitlines()))]
    if page.files:
        lines += [".Sh FILES", ".Bl -tag -width Ds", *page.files, ".El"]
    lines += [".Sh EXIT STATUS", *page.exit_status]
    lines += [".Sh EXAMPLES", *_first(_notes(examples))]
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class Page:
    """What the help texts of a program do not say."""

    title: str
    files: list[str]
    exit_status: list[str]


_PAGES = {
    "ex9000-sim": Page(
        "simulated EX9000 modules on RS-485 lines",
        [
            ".It Pa /etc/ex9000/NAME.yaml",
            "the bus file of the service",
            ".Ql ex9000-sim@NAME",
            ".It Pa /var/lib/ex9000/NAME",
            "the directory in which this service runs, with its links and EEPROM files",
            ".It Pa /run/ex9000/NAME",
            "a directory for the control socket of this service",
        ],
        [
            ".Bl -tag -width Ds",
            ".It 0",
            "a user, a signal, the control command",
            ".Ql quit",
            "or the option",
            ".Fl \\-for",
            "has ended the program; the reader of the log has closed the pipe;",
            ".Ql describe",
            "or an option such as",
            ".Fl \\-help",
            "has printed its text; or all files of",
            ".Ql play",
            "have passed",
            ".It 1",
            "a file of",
            ".Ql play",
            "has failed, or something is wrong that may be right at the next start:",
            "a port, a path or a file is in use, an address or a serial port is missing, or",
            "a capture cannot be written",
            ".It 2",
            "an argument, a bus file or a file of",
            ".Ql play",
            "is wrong, a path cannot be written, or a file is not an EEPROM image",
            ".El",
        ],
    ),
    "ex9000": Page(
        "works with EX9000 modules on an RS-485 line",
        [],
        [
            ".Bl -tag -width Ds",
            ".It 0",
            "all is well",
            ".It 1",
            "a module does not reply, refuses something or has failed, or a port or a file is",
            "not there",
            ".It 2",
            "an argument or a file is wrong",
            ".It 130",
            "the user has ended the program",
            ".El",
        ],
    ),
}


def _synopsis(program: Help) -> list[str]:
    return [".Nm", ".Op Ar OPTIONS", *(f".Ar {_text(p.names[0])} ..." for p in program.positionals)]


def _usage(subcommand: Help) -> list[str]:
    lines = [".Op Ar OPTIONS"]
    for positional in subcommand.positionals:
        lines.append(f".Op Ar {_text(positional.names[0])}{' ...' if positional.repeats else ''}")
    return lines


def _options(help_of: Help) -> list[str]:
    if not help_of.options:
        return []
    lines = [".Bl -tag -width Ds"]
    for option in help_of.positionals:
        lines += [f".It Ar {_text(option.names[0])}", *_prose(option.text)]
    for option in help_of.options:
        lines += [_tag(option), *_prose(option.text)]
    return [*lines, ".El"]


def _tag(option: Option) -> str:
    names = " , ".join("Fl " + _text(name[1:]) for name in option.names)
    return f".It {names}" + (f' Ar "{_text(option.value)}"' if option.value else "")


def _without_examples(notes: list[str]) -> tuple[list[str], list[str]]:
    """Returns the notes before the line `Examples:`, and the notes after this line."""
    if "Examples:" not in notes:
        return notes, []
    at = notes.index("Examples:")
    return notes[:at], notes[at + 1 :]


def _notes(notes: list[str]) -> list[str]:
    """Converts the paragraphs, lists and commands of the notes to mdoc."""
    lines: list[str] = []
    kind = ""
    for index, note in enumerate(notes):
        entry, continued = _ENTRY.match(note), _CONTINUED.match(note)
        following = notes[index + 1] if index + 1 < len(notes) else ""
        if not note:
            lines += _end(kind)
            kind = ""
        elif kind == "list" and continued:
            lines += _prose(continued[1])
        elif entry or (note.startswith("  ") and _CONTINUED.match(following)):
            lines += [] if kind == "list" else [*_end(kind), ".Bl -tag -width Ds"]
            kind = "list"
            tag, text = (entry[1], entry[2]) if entry else (note.strip(), "")
            lines += [f'.It Li "{_text(tag)}"', *_prose(text)]
        elif note.startswith("  ex9000"):
            lines += _end(kind)
            kind = "command"
            lines.append(f".Dl {_text(note.strip())}")
        else:
            lines += [] if kind == "paragraph" else [*_end(kind), ".Pp"]
            kind = "paragraph"
            lines += _prose(note.strip())
    return lines + _end(kind)


def _first(lines: list[str]) -> list[str]:
    """Returns the lines of a section without the unnecessary macro .Pp before the first paragraph."""
    return lines[1:] if lines[:1] == [".Pp"] else lines


def _end(kind: str) -> list[str]:
    return [".El"] if kind == "list" else []


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:].removesuffix(".") + "."


def _prose(text: str) -> list[str]:
    """Returns lines of about 80 characters at most. Each sentence begins on a new line, as mdoc recommends."""
    lines = []
    for sentence in re.split(r"(?<=[.!?]) +(?=[A-Z`-])", text):
        line = ""
        for word in _text(sentence).split():
            if line and len(line) + len(word) > 78:
                lines.append(line)
                line = ""
            line = f"{line} {word}".strip()
        lines.append(line)
    return [_not_a_macro(line) for line in lines if line]


def _text(text: str) -> str:
    """Returns `text` with its special characters escaped (_ESCAPES)."""
    for character, escape in _ESCAPES.items():
        text = text.replace(character, escape)
    return text


def _not_a_macro(line: str) -> str:
    """Returns a line of text in a form that mdoc does not interpret as a macro."""
    return "\\&" + line if line.startswith(".") else line
