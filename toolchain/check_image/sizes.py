"""What an image takes of flash and RAM, and what takes it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from check_image.elf import Elf, Section, Symbol
from check_image.functions import demangle, without_parameters

# Armv7-M ARM B3.1, the system address map: SRAM, whatever the chip.
_RAM = range(0x20000000, 0x40000000)


def flash(elf: Elf) -> int:
    """Bytes: code, tables, vectors, and the first values of variables."""
    return sum(section.size for section in elf.sections if section.loaded)


def static_ram(elf: Elf) -> int:
    """Bytes of variables, whether they have first values or not; a room that is set aside as stack is none."""
    return sum(s.size for s in elf.sections if s.address in _RAM and not s.name.startswith(".stack"))


def by_symbol(elf: Elf) -> list[tuple[int, str]]:
    """Flash a symbol, the most first."""
    symbols = _in_flash(elf)
    readable = demangle([symbol.name for symbol in symbols])
    return sorted(((s.size, without_parameters(readable[s.name])) for s in symbols), reverse=True)


def by_folder(elf: Elf, locations: Mapping[int, str], root: Path) -> list[tuple[int, str]]:
    """Flash a source folder, the most first; `locations` are of functions, by address. Tables have no location."""
    sums: dict[str, int] = {}
    for symbol in _in_flash(elf):
        location = locations.get(symbol.address)
        if location is not None:
            folder = _folder(location, root)
        else:
            folder = "(unrecorded code)" if symbol.is_function else "(tables)"
        sums[folder] = sums.get(folder, 0) + symbol.size
    rest = flash(elf) - sum(sums.values())
    sums["(vectors, padding, unnamed constants)"] = rest
    return sorted(((size, folder) for folder, size in sums.items() if size), reverse=True)


def _folder(location: str, root: Path) -> str:
    path = Path(re.sub(r":\d+:\d+$", "", location))
    return str(path.parent.relative_to(root) if path.is_relative_to(root) else path.parent)


def _in_flash(elf: Elf) -> list[Symbol]:
    """Each loaded symbol, once where it has several names."""
    seen: dict[int, Symbol] = {}
    for symbol in elf.symbols:
        if symbol.size and _is_loaded(symbol.section):
            seen.setdefault(symbol.address, symbol)
    return list(seen.values())


def _is_loaded(section: Section | None) -> bool:
    return section is not None and section.loaded
