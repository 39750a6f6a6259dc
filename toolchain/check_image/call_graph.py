"""The call graph that GCC writes (-fcallgraph-info=su, text in the form of VCG): functions, frames, calls."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

INDIRECT = "__indirect_call"

_NODE = re.compile(r'node: \{ title: "([^"]*)" label: "(.*)"(?: shape : ellipse)? \}$')
_EDGE = re.compile(r'edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"(?: label: "([^"]*)")? \}$')
_STACK = re.compile(r"(\d+) bytes \((static|dynamic|dynamic,bounded)\)$")


class NotACallGraph(Exception):
    """The text is not what GCC 12 writes."""


@dataclass(frozen=True)
class Title:
    """What a call graph calls a function: a static one has its source file in front."""

    file: str  # empty where the name is global
    name: str

    @staticmethod
    def parse(text: str) -> Title:
        file, _, name = text.rpartition(":")
        return Title(file, name.lstrip("*"))  # an asterisk stands where the name was given by asm("")


@dataclass
class Record:
    """A function that was compiled."""

    title: Title
    location: str  # file:line:column
    frame: int  # bytes
    is_bounded: bool  # false where the stack grows by what is known only when it runs
    calls: set[Title] = field(default_factory=set)
    indirect_calls: list[str] = field(default_factory=list)  # their locations; empty where GCC knows none


def parse(text: str) -> list[Record]:
    """The functions of one translation unit."""
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
    if stack:  # else it is called here, and compiled elsewhere
        records[match.group(1)] = Record(
            title=Title.parse(match.group(1)),
            location=label[1],
            frame=int(stack.group(1)),
            is_bounded=stack.group(2) != "dynamic",
        )
