"""Reads the call graph that GCC writes with -fcallgraph-info=su (text in the VCG format): functions, frames and
calls."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

INDIRECT = "__indirect_call"

_NODE = re.compile(r'node: \{ title: "([^"]*)" label: "(.*)"(?: shape : ellipse)? \}$')
_EDGE = re.compile(r'edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"(?: label: "([^"]*)")? \}$')
_STACK = re.compile(r"(\d+) bytes \((static|dynamic|dynamic,bounded)\)$")


class NotACallGraph(Exception):
    """The text does not have the format of GCC 12. The message contains the unexpected line."""


@dataclass(frozen=True)
class Title:
    """The name of a function in a call graph. GCC writes the name of the source file before the name of a function if
    the function is local to its translation unit, is inline, or is an instance of a template. With -fwhole-program, a
    function is local unless it is `main` or has the attribute `externally_visible`."""

    file: str  # empty if GCC writes only the name of the function
    name: str

    @staticmethod
    def parse(text: str) -> Title:
        file, _, name = text.rpartition(":")
        return Title(file, name.lstrip("*"))  # an asterisk precedes a name that the source sets with asm("NAME")


@dataclass
class Record:
    """A function that the compiler has compiled."""

    title: Title
    location: str  # file:line:column
    frame: int  # bytes
    is_bounded: bool  # false if the stack use is known only at run time
    calls: set[Title] = field(default_factory=set)
    indirect_calls: list[str] = field(default_factory=list)  # the location of each; "" if GCC does not know it


def parse(text: str) -> list[Record]:
    """Returns the functions of one translation unit. Raises NotACallGraph at an unexpected line."""
    records: dict[str, Record] = {}
    for line in text.splitlines():
        if line.startswith("node: "):
            _parse_node(line, records)
        elif line.startswith("edge: "):
            match = _EDGE.match(line)
            if match is None or match.group(1) not in records:
                raise NotACallGraph(line)
            source = records[match.group(1)]
            if match.group(2) == INDIRECT:
                source.indirect_calls.append(match.group(3) or "")
            else:
                source.calls.add(Title.parse(match.group(2)))
        elif line not in ("}", "") and not line.startswith("graph: "):
            raise NotACallGraph(line)
    return list(records.values())


def _parse_node(line: str, records: dict[str, Record]) -> None:
    match = _NODE.match(line)
    if match is None:
        raise NotACallGraph(line)
    label = match.group(2).split("\\n")
    stack = _STACK.match(label[2]) if len(label) > 2 else None
    if stack:  # a node without a stack is INDIRECT, or a function that this unit calls, but does not contain
        records[match.group(1)] = Record(
            title=Title.parse(match.group(1)),
            location=label[1],
            frame=int(stack.group(1)),
            is_bounded=stack.group(2) != "dynamic",
        )
