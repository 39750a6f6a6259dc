"""The functions of an image: their start, end and names."""

from __future__ import annotations

import bisect
import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import PurePath

from elf_file import Elf, Symbol


@dataclass(frozen=True)
class Function:
    name: str  # mangled
    readable: str  # demangled, with parameters
    address: int
    end: int
    names: tuple[str, ...]  # the name and its aliases

    def __str__(self) -> str:
        return without_parameters(self.readable)


class Functions:
    """All functions of an image, by address and by name."""

    def __init__(self, elf: Elf) -> None:
        symbols = _function_symbols(elf)
        readable = demangle(sorted({symbol.name for symbol in symbols}))
        by_address: dict[int, list[Symbol]] = {}
        for symbol in symbols:
            by_address.setdefault(symbol.address, []).append(symbol)
        self._starts = sorted(by_address)
        self._by_address: dict[int, Function] = {}
        self._locals: dict[str, list[tuple[str, Function]]] = {}
        self._globals: dict[str, Function] = {}
        for index, start in enumerate(self._starts):
            here = by_address[start]
            # A function of the compiler has a size, so it takes precedence over a label of the assembler. If the sizes
            # are equal, a global name takes precedence over a local one.
            first = max(here, key=lambda symbol: (symbol.size, not symbol.is_local))
            function = Function(
                name=first.name,
                readable=readable[first.name],
                address=start,
                end=start + first.size if first.size else self._end_of_unsized(first, index),
                names=tuple(symbol.name for symbol in here),
            )
            self._by_address[start] = function
            for symbol in here:
                if symbol.is_local:
                    self._locals.setdefault(symbol.name, []).append((symbol.file, function))
                else:
                    self._globals[symbol.name] = function

    def __iter__(self) -> Iterator[Function]:
        return iter(self._by_address.values())

    def at(self, address: int) -> Function | None:
        """Returns the function that begins at an address, or None if there is none."""
        return self._by_address.get(address)

    def around(self, address: int) -> Function | None:
        """Returns the function whose code contains an address, or None if there is none."""
        index = bisect.bisect_right(self._starts, address) - 1
        function = self._by_address[self._starts[index]] if index >= 0 else None
        return function if function is not None and address < function.end else None

    def global_named(self, name: str) -> Function | None:
        return self._globals.get(name)

    def local_named(self, name: str, file: str) -> Function | None:
        """Returns the static function with this name in a source file, or None if there is none.

        If only one static function has this name, returns this function without a comparison of the files. Otherwise
        compares the names of the files without their folders, because symbols do not contain the folders.
        """
        there = self._locals.get(name, [])
        if len(there) == 1:
            return there[0][1]
        return next(
            (function for source, function in there if PurePath(source).name == PurePath(file).name), None
        )

    def named(self, name: str) -> list[Function]:
        """Returns all functions with this name, from any file."""
        found = self._globals.get(name)
        return ([found] if found else []) + [function for _, function in self._locals.get(name, [])]

    def _end_of_unsized(self, symbol: Symbol, index: int) -> int:
        assert symbol.section is not None
        end = symbol.section.address + symbol.section.size
        return min(end, self._starts[index + 1]) if index + 1 < len(self._starts) else end


def demangle(names: list[str]) -> dict[str, str]:
    """Returns the demangled form of each mangled name."""
    # c++filt reads one name from each line. The suffix of a clone, such as .constprop.0, is removed, because c++filt
    # would write it after the parameters, as [clone .constprop.0].
    plain = [name.split(".", 1)[0] for name in names]
    done = subprocess.run(
        ["arm-none-eabi-c++filt"], input="\n".join(plain), capture_output=True, text=True, check=True
    )
    return dict(zip(names, done.stdout.split("\n")))


def without_parameters(readable: str) -> str:
    """Returns a demangled name without parameters, return type and anonymous namespaces, for example
    `a::b::{lambda#1}::operator()` for `a::b(int)::{lambda(int)#1}::operator()(int) const`."""
    text = readable.replace("(anonymous namespace)::", "").replace("operator()", "operator\0")
    while (shorter := re.sub(r"\([^()]*\)( const)?", "", text)) != text:
        text = shorter
    # The demangled name of a template instance begins with the return type.
    text = re.sub(r"^[^<>{}]+? (?=[\w:]+<)", "", text) if "operator " not in text else text
    return text.replace("operator\0", "operator()")


def _function_symbols(elf: Elf) -> list[Symbol]:
    """Returns the symbols of functions, and of assembler labels that are not inside a function or an object."""
    code = [s for s in elf.symbols if s.section is not None and s.section.executable]
    functions = [s for s in code if s.is_function]
    extents = sorted((s.address, s.address + s.size) for s in code if s.has_type)
    starts = [start for start, _ in extents]

    def is_inside(symbol: Symbol) -> bool:
        index = bisect.bisect_right(starts, symbol.address) - 1
        return index >= 0 and symbol.address < extents[index][1]

    labels = [s for s in code if not s.has_type and _holds(s) and not is_inside(s)]
    return functions + labels


def _holds(symbol: Symbol) -> bool:
    """Returns whether code or data follows a label in its section. A label of a linker script can be at the end."""
    section = symbol.section
    return section is not None and section.address <= symbol.address < section.address + section.size
