"""Which functions a call through a pointer can reach, by the types that GCC's own dump gives it.

The call graph says of such a call only where it stands. The dump of the optimised program
(-fdump-tree-optimized-lineno) says more: the type of the function pointer, or the slot of the virtual table.
Whatever is not understood excludes nothing.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from check_image.functions import Function

_HEADER = re.compile(r";; Function .*\((\S+), funcdef_no=")
_LOCATION = re.compile(r"^  \[([^]]+:\d+:\d+)\] ")
_POINTER = re.compile(r"^  .*?\(\*<T\w+>\) \((.*)\) (\w+);$")
_VIRTUAL_CALL = re.compile(r"OBJ_TYPE_REF\(.*;\((const )?[^)]*\)[^>]*->(\d+)B?\) \((.*)\)")
_POINTER_CALL = re.compile(r"(?:^| = |\] )(\w+)(?:\(D\))? \((.*)\);")


@dataclass(frozen=True)
class PointerCall:
    """A call through a pointer to a function."""

    parameters: tuple[str, ...] | None  # None where only their number is known
    count: int

    def can_reach(self, target: Function) -> bool:
        theirs = parameters_of(target.readable)
        if theirs is None:
            return True
        ours = self.parameters if self.parameters is not None else ("",) * self.count
        return _agree(ours, theirs) or (
            # through a pointer to a member function, which names its class first
            len(ours) > 0 and _agree(ours[1:], theirs) and "::" in target.readable
        )


@dataclass(frozen=True)
class VirtualCall:
    """A call of a virtual function: the slot in its class's table, from 0."""

    slot: int
    is_const: bool
    count: int  # of parameters, without the object

    def can_reach(self, target: Function) -> bool:
        theirs = parameters_of(target.readable)
        return theirs is None or (
            len(theirs) == self.count and target.readable.endswith(" const") == self.is_const
        )


CallSite = PointerCall | VirtualCall


def parse(text: str) -> dict[tuple[str, str], set[CallSite]]:
    """The calls through pointers of one translation unit, by mangled caller and location."""
    sites: dict[tuple[str, str], set[CallSite]] = {}
    caller = ""
    pointers: dict[str, tuple[str, ...]] = {}
    for line in text.splitlines():
        header = _HEADER.match(line)
        if header:
            caller, pointers = header.group(1), {}
        declared = _POINTER.match(line)
        if declared:
            pointers[declared.group(2)] = split_list(declared.group(1))
        site = _call_site(line, pointers)
        location = _LOCATION.match(line)
        if site and location:
            sites.setdefault((caller, location.group(1)), set()).add(site)
    return sites


def _call_site(line: str, pointers: dict[str, tuple[str, ...]]) -> CallSite | None:
    virtual = _VIRTUAL_CALL.search(line)
    if virtual:
        count = len(split_list(virtual.group(3))) - 1
        return VirtualCall(int(virtual.group(2)), virtual.group(1) is not None, count)
    call = _POINTER_CALL.search(line)
    if call:
        # A direct call looks the same; it is never asked for, because the call graph has it.
        arguments = split_list(call.group(2))
        return PointerCall(pointers.get(call.group(1)), len(arguments))
    return None


def split_list(text: str) -> tuple[str, ...]:
    """`a, b<c, d>, e (f, g)` has three parts."""
    parts, depth, part = [], 0, ""
    for character in text:
        depth += (character in "(<[{") - (character in ")>]}")
        if character == "," and depth == 0:
            parts.append(part.strip())
            part = ""
        else:
            part += character
    parts.append(part.strip())
    return tuple(parts) if parts not in ([""], ["void"]) else ()


def parameters_of(readable: str) -> tuple[str, ...] | None:
    """The parameters' types of a demangled function; None where the name does not tell, as in C."""
    text = readable.removesuffix(" const")
    if not text.endswith(")"):
        return None
    depth = 0
    for index in range(len(text) - 1, -1, -1):
        depth += (text[index] == ")") - (text[index] == "(")
        if depth == 0:
            return split_list(text[index + 1 : -1])
    return None


@dataclass(frozen=True)
class _Shape:
    """As much of a type as both spellings show."""

    kind: str  # "class", "number", or "named": a class or an enumeration
    name: str
    indirections: str  # `*` and `&`


_NUMBERS = {"bool", "char", "short", "int", "long", "signed", "unsigned", "float", "double"}


def _agree(ours: tuple[str, ...], theirs: tuple[str, ...]) -> bool:
    return len(ours) == len(theirs) and all(
        _may_be_same(_shape_in_dump(a), _shape_demangled(b)) for a, b in zip(ours, theirs)
    )


def _may_be_same(ours: _Shape | None, theirs: _Shape | None) -> bool:
    if ours is None or theirs is None:
        return True
    if ours.indirections != theirs.indirections:
        return False
    if ours.kind == "number":
        return theirs.kind == "number"
    return theirs.kind == "named" and ours.name == theirs.name


def _shape_in_dump(text: str) -> _Shape | None:
    """Of `const struct State &`, `unsigned int`, `uint16_t`; None where it may be anything, as an alias."""
    name, indirections = _take_apart(text)
    if "(" in text:
        return None
    record = re.fullmatch(r"(?:struct|union|class) (\w+)(<.*>)?", name)
    if record:
        return _Shape("class", record.group(1), indirections)
    if set(name.split()) <= _NUMBERS and name:
        return _Shape("number", "", indirections)
    if re.fullmatch(r"u?int(8|16|32|64)_t|size_t", name):
        return _Shape("number", "", indirections)
    return None


def _shape_demangled(text: str) -> _Shape | None:
    """Of `ex9000::State const&`, `unsigned short`; None where it is not plain."""
    name, indirections = _take_apart(text)
    if "(" in text:
        return None
    if set(name.split()) <= _NUMBERS:
        return _Shape("number", "", indirections)
    return _Shape("named", re.sub(r"<.*", "", name).rpartition("::")[2], indirections)


def _take_apart(text: str) -> tuple[str, str]:
    words = re.sub(r"\b(const|volatile|restrict)\b", " ", text)
    return " ".join(re.sub(r"[*&]", " ", words).split()), "".join(re.findall(r"[*&]", words))
