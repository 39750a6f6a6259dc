"""Uses the types in GCC's dump to decide which functions a call through a pointer can reach.

The call graph contains only the location of such a call. The dump of the optimised program
(-fdump-tree-optimized-lineno) also contains the type of the function pointer, or the slot of the virtual table. A
parameter type that this file does not understand counts as equal to every type.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from check_image.functions import Function

_HEADER = re.compile(r";; Function .*\((\S+), funcdef_no=")
_LOCATION = re.compile(r"^  \[([^]]+:\d+:\d+)\] ")
# The declaration of a pointer to a function, `Refusal (*<T44ec>) (const struct State &, struct Bytes) _5;`, or to a
# member function, `void Thing::<T2b8> (struct Thing *) * f;`.
_POINTER = re.compile(r"^  .*?(?:\(\*<T\w+>\) \((.*)\)|::<T\w+> \((.*)\) \*) ([\w.]+);$")
_VIRTUAL_CALL = re.compile(r"OBJ_TYPE_REF\(.*;\((const )?[^)]*\)[^>]*->(\d+)B?\) \((.*)\)")
_POINTER_CALL = re.compile(r"(?:^| = |\] )([\w.]+)(?:\(D\))? \((.*)\);")


@dataclass(frozen=True)
class PointerCall:
    """A call through a pointer to a function or to a member function."""

    parameters: tuple[str, ...] | None  # types; None if only the number of arguments is known
    count: int  # number of arguments

    def can_reach(self, target: Function) -> bool:
        theirs = parameters_of(target.readable)
        if theirs is None:
            return True
        ours = self.parameters if self.parameters is not None else ("",) * self.count
        if _agree(ours, theirs):
            return True
        # For a pointer to a member function, the first parameter is the object.
        return len(ours) > 0 and _may_be_object(ours[0]) and _agree(ours[1:], theirs)


@dataclass(frozen=True)
class VirtualCall:
    """A call of a virtual function. `slot` is the index of the function in the virtual table, from 0."""

    slot: int
    is_const: bool
    count: int  # number of parameters, without the object

    def can_reach(self, target: Function) -> bool:
        theirs = parameters_of(target.readable)
        return theirs is None or (
            len(theirs) == self.count and target.readable.endswith(" const") == self.is_const
        )


CallSite = PointerCall | VirtualCall


def parse(text: str) -> dict[tuple[str, str], set[CallSite]]:
    """Returns the calls through pointers in one translation unit, by the mangled name of the caller and by location."""
    sites: dict[tuple[str, str], set[CallSite]] = {}
    caller = ""
    pointers: dict[str, tuple[str, ...]] = {}
    for line in text.splitlines():
        header = _HEADER.match(line)
        if header:
            caller, pointers = header.group(1), {}
        declared = _POINTER.match(line)
        if declared:
            pointers[declared.group(3)] = split_list(declared.group(1) or declared.group(2) or "")
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
        name, arguments = call.group(1), split_list(call.group(2))
        variable, numbered = re.subn(r"_\d+$", "", name)  # the name of an SSA value ends with a number
        parameters = pointers.get(name, pointers.get(variable))
        if numbered or parameters is not None:
            return PointerCall(parameters, len(arguments))
    return None


def split_list(text: str) -> tuple[str, ...]:
    """Splits a list at the commas outside of brackets: `a, b<c, d>, e (f, g)` has three parts. An empty list and `void`
    have none."""
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
    """Returns the parameter types in a demangled name. Returns None if the name has no parameter list, for example if
    it is the name of a C function."""
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
    """The part of a type that the dump and the demangled name both contain."""

    kind: str  # "number", "class" (only in the dump), or "named" (only in a demangled name: a class or an enumeration)
    name: str
    indirections: str  # `*` and `&`


# The words of numeric types in the dump and in demangled names, and the definitions of the standard integer types on
# Arm with newlib.
_NUMBERS = {"bool", "char", "short", "int", "long", "signed", "unsigned", "float", "double", "wchar_t"}
_ALIASES = {
    "int8_t": "signed char",
    "uint8_t": "unsigned char",
    "int16_t": "short int",
    "uint16_t": "short unsigned int",
    "int32_t": "long int",
    "uint32_t": "long unsigned int",
    "int64_t": "long long int",
    "uint64_t": "long long unsigned int",
    "size_t": "unsigned int",
}


def _agree(ours: tuple[str, ...], theirs: tuple[str, ...]) -> bool:
    return len(ours) == len(theirs) and all(
        _may_be_same(_shape_in_dump(a), _shape_demangled(b)) for a, b in zip(ours, theirs)
    )


def _may_be_object(ours: str) -> bool:
    shape = _shape_in_dump(ours)
    return shape is None or (shape.kind == "class" and shape.indirections == "*")


def _may_be_same(ours: _Shape | None, theirs: _Shape | None) -> bool:
    if ours is None or theirs is None:
        return True
    if ours.indirections != theirs.indirections:
        return False
    return ours.name == theirs.name and (ours.kind == "number") == (theirs.kind == "number")


def _shape_in_dump(text: str) -> _Shape | None:
    """Returns the shape of a type in the dump, for example of `const struct State &`, `unsigned int` or `uint16_t`.
    Returns None if `text` can mean any type, for example because it is an alias that is not in _ALIASES."""
    name, indirections = _take_apart(text)
    if "(" in text:
        return None
    record = re.fullmatch(r"(?:struct|union|class) (\w+)(<.*>)?", name)
    if record:
        return _Shape("class", record.group(1), indirections)
    return _number(_ALIASES.get(name, name), indirections)


def _shape_demangled(text: str) -> _Shape | None:
    """Returns the shape of a demangled type, for example of `ex9000::State const&` or `unsigned short`. Returns None if
    the type contains parentheses, for example if it is a pointer to a function."""
    name, indirections = _take_apart(text)
    if "(" in text:
        return None
    return _number(name, indirections) or _Shape(
        "named", re.sub(r"<.*", "", name).rpartition("::")[2], indirections
    )


def _number(name: str, indirections: str) -> _Shape | None:
    """Returns the shape of a numeric type, or None for other types. `long unsigned int` and `unsigned long` have equal
    shapes."""
    words = name.split()
    if not words or not set(words) <= _NUMBERS:
        return None
    if len(words) > 1:
        words = sorted(word for word in words if word != "int" and (word != "signed" or "char" in words))
    return _Shape("number", " ".join(words or ["int"]), indirections)


def _take_apart(text: str) -> tuple[str, str]:
    words = re.sub(r"\b(const|volatile|restrict)\b", " ", text)
    return " ".join(re.sub(r"[*&]", " ", words).split()), "".join(re.findall(r"[*&]", words))
