"""Reads the sections and symbols of a linked 32-bit little-endian ELF file for Arm (ELF 1.2, book I; AAELF32)."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

# sh_type
_SYMBOL_TABLE = 2
_NO_BITS = 8
# sh_flags
_ALLOCATED = 0x2
_EXECUTABLE = 0x4
# st_shndx
_UNDEFINED = 0
# st_info
_LOCAL = 0
_NO_TYPE, _OBJECT, _FUNCTION, _FILE = 0, 1, 2, 4
_ARM = 40


class NotAnImage(Exception):
    """The file is not a 32-bit little-endian ELF file for Arm."""


@dataclass(frozen=True)
class Section:
    name: str
    address: int
    size: int
    allocated: bool
    executable: bool
    loaded: bool  # allocated, and its content is in the file, so it requires flash
    data: bytes  # empty if not loaded


@dataclass(frozen=True)
class Symbol:
    name: str
    address: int  # for a function, the address without the Thumb bit
    size: int
    is_function: bool
    is_object: bool
    has_type: bool
    is_local: bool
    file: str  # name of the source file of a local symbol; empty for a global symbol, or if unknown
    section: Section | None  # None if absolute or undefined
    is_undefined: bool


class Elf:
    def __init__(self, path: Path) -> None:
        self._file = path.read_bytes()
        if self._file[:6] != b"\x7fELF\x01\x01" or struct.unpack_from("<H", self._file, 18)[0] != _ARM:
            raise NotAnImage(f"{path}: the file is not a 32-bit little-endian ELF file for Arm; name the linked image")
        offset, entry_size, count, names = struct.unpack_from("<32xI10xHHH", self._file)
        headers = [struct.unpack_from("<10I", self._file, offset + i * entry_size) for i in range(count)]
        name_table = headers[names][4]
        self._by_index = [self._section(header, name_table) for header in headers]
        self.sections = [section for section in self._by_index if section.allocated]
        self.symbols: list[Symbol] = []
        for header in headers:
            if header[1] == _SYMBOL_TABLE:
                self._read_symbols(header, headers[header[6]][4])

    def word_at(self, address: int) -> int | None:
        """Returns the word at an address, or None if no loaded section contains it."""
        for section in self.sections:
            if section.loaded and section.address <= address <= section.address + section.size - 4:
                return int(struct.unpack_from("<I", section.data, address - section.address)[0])
        return None

    def named(self, name: str) -> Section | None:
        return next((section for section in self.sections if section.name == name), None)

    def _section(self, header: tuple[int, ...], name_table: int) -> Section:
        name, kind, flags, address, offset, size = header[:6]
        loaded = bool(flags & _ALLOCATED) and kind != _NO_BITS
        return Section(
            name=self._text(name_table + name),
            address=address,
            size=size,
            allocated=bool(flags & _ALLOCATED),
            executable=bool(flags & _EXECUTABLE),
            loaded=loaded,
            data=self._file[offset : offset + size] if loaded else b"",
        )

    def _read_symbols(self, header: tuple[int, ...], names: int) -> None:
        offset, size = header[4:6]
        file = ""
        for name_offset, value, extent, info, _, index in struct.iter_unpack(
            "<IIIBBH", self._file[offset : offset + size]
        ):
            name = self._text(names + name_offset)
            kind, is_local = info & 0xF, info >> 4 == _LOCAL
            if kind == _FILE:
                file = name
            elif name and not name.startswith("$"):  # AAELF32 5.5.5: $a, $d, $t only mark code and data
                self.symbols.append(
                    Symbol(
                        name=name,
                        address=value & ~1 if kind == _FUNCTION else value,
                        size=extent,
                        is_function=kind == _FUNCTION,
                        is_object=kind == _OBJECT,
                        has_type=kind != _NO_TYPE,
                        is_local=is_local,
                        file=file if is_local else "",
                        section=self._by_index[index] if 0 < index < len(self._by_index) else None,
                        is_undefined=index == _UNDEFINED,
                    )
                )

    def _text(self, offset: int) -> str:
        return self._file[offset : self._file.index(b"\0", offset)].decode()
