"""Finds forbidden contents of an image: undefined symbols, a heap, exceptions, unwind tables, the C++ run-time library,
floating point, 64-bit division, globals that are initialised at run time, and texts for people."""

from __future__ import annotations

import pathlib
import re
from collections.abc import Iterable

from check_image.call_graph import Record
from check_image.disassembly import Disassembly
from elf_file import Elf

_SYMBOLS = [
    (re.compile(pattern), what)
    for pattern, what in (
        (r"_?(malloc|calloc|realloc|free|sbrk)(_r)?$", "heap"),
        (r"_Z(nw|na|dl|da)", "heap"),  # operator new, new[], delete, delete[]
        (r"_Unwind_|__(aeabi|gnu)_unwind", "exceptions"),
        (r"__cxa_", "the C++ run-time library"),
        (r"__aeabi_u?ldivmod$|__u?(div|mod|divmod)di[34]$", "64-bit division"),
        # The names of section 4.1.2 of the Run-time ABI for the Arm Architecture, and libgcc's internal names.
        (r"__aeabi_([fdh]|c[fd]|u?[il]2[fd])", "floating point"),
        (r"__gnu_[dfh]2|__(?!gnu)[a-z]+[hsdt]f([hsdt][fi])?[23]?$", "floating point"),
        (r"_GLOBAL__(sub_)?[ID]_", "globals initialised at run time"),
    )
]
_SECTIONS = [
    (re.compile(pattern), what)
    for pattern, what in (
        (r"\.ARM\.ex(idx|tab)|\.eh_frame|\.gcc_except_table", "unwind tables"),
        (r"\.(preinit_array|init_array|fini_array|ctors|dtors)", "globals initialised at run time"),
    )
]
_FIRMWARE = pathlib.Path(__file__).resolve().parents[2] / "firmware"
# The tables of the core whose texts are only for people, so an image must not contain them.
_TABLES = ("dcon/commands.hpp", "modbus/functions.hpp", "registers/bits.hpp", "registers/words.hpp")
_SHORTEST_TEXT = 12  # an image may contain a shorter text by chance, or for another reason


def texts_for_people() -> set[bytes]:
    """Returns the texts in the tables of the core that have at least 12 characters."""
    found: set[bytes] = set()
    for name in _TABLES:
        source = (_FIRMWARE / name).read_bytes()
        rows = b"".join(re.findall(rb" k\w+\[\] = \{\n.*?\n\};", source, re.DOTALL))
        texts = {text for text in re.findall(rb'"([^"\n]*)"', rows) if len(text) >= _SHORTEST_TEXT}
        if not texts:
            raise ValueError(f"{_FIRMWARE / name}: contains no table with texts; correct check_image/forbidden.py")
        found |= texts
    return found


def problems(elf: Elf, records: Iterable[Record], disassembly: Disassembly) -> list[str]:
    found = []
    for symbol in elf.symbols:
        if symbol.is_undefined:
            found.append(f"{symbol.name}: undefined; link a definition")
        what = _what(symbol.name)
        if what:
            found.append(f"{symbol.name}: {what}; an image must not contain this symbol")
    for section in elf.sections:
        for pattern, what in _SECTIONS:
            if section.size and pattern.match(section.name):
                found.append(f"section {section.name}: {what}; an image must not contain this section")
        for text in sorted(texts_for_people()):
            if text in section.data:
                found.append(
                    f"section {section.name}: contains the text '{text.decode()}'; an image must not contain it"
                )
    # The linker silently discards the functions that initialise globals, unless its script keeps .init_array. The
    # compiler's records contain these functions.
    for record in records:
        if _what(record.title.name) == "globals initialised at run time":
            found.append(f"{record.location}: globals initialised at run time; use constant initial values")
    # If code uses a floating-point unit, an exception frame can be longer than check-image calculates.
    if any(each.mnemonic.startswith("v") and each.operands for each in disassembly.instructions.values()):
        found.append("the image contains instructions of a floating-point unit; compile with -mfloat-abi=soft")
    return found


def _what(name: str) -> str:
    return next((what for pattern, what in _SYMBOLS if pattern.match(name)), "")
