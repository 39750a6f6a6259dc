"""Calculates the static RAM of an image, and the flash of the whole image, of each symbol and of each folder."""

from __future__ import annotations

import subprocess
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from check_image.functions import demangle, without_parameters
from elf_file import Elf, Section, Symbol

# Before the start of the image only, or next to it in the flash: the same in every image of a board.
_NOT_OF_THE_IMAGE = (".second_stage", ".loader", ".head_0", ".head_1")

# The SRAM region of the system address map. It is the same on all boards (Armv7-M ARM B3.1).
RAM = range(0x20000000, 0x40000000)


def flash(elf: Elf) -> int:
    """Returns the total size in bytes of the sections of the image that are stored in flash, for example code and
    initial values of variables."""
    return sum(section.size for section in _of_the_image(elf) if section.loaded)


def static_ram(elf: Elf) -> int:
    """Returns the total size in bytes of the sections in RAM: variables, and the code of an image that runs from RAM.
    Does not count a section that reserves the stack."""
    return sum(s.size for s in _of_the_image(elf) if s.address in RAM and not s.name.startswith(".stack"))


def _of_the_image(elf: Elf) -> list[Section]:
    return [section for section in elf.sections if section.name not in _NOT_OF_THE_IMAGE]


def by_symbol(elf: Elf) -> list[tuple[int, str]]:
    """Returns the flash in bytes and the name of each symbol, largest first."""
    symbols = _in_flash(elf)
    readable = demangle([symbol.name for symbol in symbols])
    return sorted(((s.size, without_parameters(readable[s.name])) for s in symbols), reverse=True)


def by_folder(elf: Elf, path: Path, locations: Mapping[int, str], root: Path) -> list[tuple[int, str]]:
    """Returns the flash in bytes of each source folder, and of the content that belongs to no folder, largest first.

    Each halfword of code counts for the folder of its source file. Inlined code therefore counts for the folder in
    which it was written. If the debugging information names no source file for a halfword, the halfword counts for the
    folder of its function. `locations` contains the source locations of functions, by address.
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
    """Returns the symbols that have a size and are stored in flash. If several of these symbols have the same address,
    returns only the first of them."""
    seen: dict[int, Symbol] = {}
    for symbol in elf.symbols:
        if symbol.size and _is_loaded(symbol.section):
            seen.setdefault(symbol.address, symbol)
    return list(seen.values())


def _is_loaded(section: Section | None) -> bool:
    return section is not None and section.loaded and section.name not in _NOT_OF_THE_IMAGE
