"""Calculates the flash and RAM that an image requires, in total and by symbol and folder."""

from __future__ import annotations

import subprocess
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from check_image.elf import Elf, Section, Symbol
from check_image.functions import demangle, without_parameters

# SRAM in the system address map, the same for all chips (Armv7-M ARM B3.1).
RAM = range(0x20000000, 0x40000000)


def flash(elf: Elf) -> int:
    """Returns the bytes of code, tables, vectors, and initial values of variables."""
    return sum(section.size for section in elf.sections if section.loaded)


def static_ram(elf: Elf) -> int:
    """Returns the bytes of variables with or without initial values. Does not count a section that reserves the
    stack."""
    return sum(s.size for s in elf.sections if s.address in RAM and not s.name.startswith(".stack"))


def by_symbol(elf: Elf) -> list[tuple[int, str]]:
    """Returns the flash of each symbol in bytes, largest first."""
    symbols = _in_flash(elf)
    readable = demangle([symbol.name for symbol in symbols])
    return sorted(((s.size, without_parameters(readable[s.name])) for s in symbols), reverse=True)


def by_folder(elf: Elf, path: Path, locations: Mapping[int, str], root: Path) -> list[tuple[int, str]]:
    """Returns the flash of each source folder in bytes, largest first.

    Code is attributed by line, so that inlined code counts where it was written. A function without debugging
    information counts as a whole: `locations` contains the locations of functions, by address.
    """
    sums: Counter[str] = Counter()
    code = [symbol for symbol in _in_flash(elf) if symbol.is_function]
    sources = iter(_sources(path, [address for symbol in code for address in _halfwords(symbol)]))
    for symbol in code:
        for _ in _halfwords(symbol):
            source = next(sources)
            sums[_folder(source if source != "??" else locations.get(symbol.address, ""), root)] += 2
    sums["(tables)"] = sum(symbol.size for symbol in _in_flash(elf) if not symbol.is_function)
    sums["(vectors, padding, constants without a name)"] = flash(elf) - sum(sums.values())
    return sorted(((size, folder) for folder, size in sums.items() if size), reverse=True)


def _halfwords(symbol: Symbol) -> range:
    return range(symbol.address, symbol.address + symbol.size, 2)


def _sources(path: Path, addresses: list[int]) -> list[str]:
    """Returns the source file of each address, or `??` if it is unknown."""
    done = subprocess.run(
        ["arm-none-eabi-addr2line", "-e", str(path)],
        input="\n".join(map(hex, addresses)),
        capture_output=True,
        text=True,
        check=True,
    )
    return [line.partition(":")[0] for line in done.stdout.splitlines()]


def _folder(source: str, root: Path) -> str:
    if not source:
        return "(unrecorded code)"
    path = Path(source.partition(":")[0])
    if path.is_relative_to(root):
        return str(path.parent.relative_to(root))
    return "(C++ library)" if "include" in path.parts else str(path.parent)


def _in_flash(elf: Elf) -> list[Symbol]:
    """Returns each loaded symbol, once even if it has several names."""
    seen: dict[int, Symbol] = {}
    for symbol in elf.symbols:
        if symbol.size and _is_loaded(symbol.section):
            seen.setdefault(symbol.address, symbol)
    return list(seen.values())


def _is_loaded(section: Section | None) -> bool:
    return section is not None and section.loaded
