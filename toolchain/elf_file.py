"""Reads linked 32-bit little-endian ELF files for Arm, with pyelftools: Debian's package python3-pyelftools."""

from __future__ import annotations

import io
import struct
from dataclasses import dataclass
from pathlib import Path

from elftools.common.exceptions import ELFError
from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection


class NotAnImage(Exception):
    """The file is damaged, or it is not the image that the caller expects."""


class NotElf(NotAnImage):
    """The file is not a 32-bit little-endian ELF file for Arm."""


@dataclass(frozen=True)
class Segment:
    offset: int  # in the file
    address: int  # address of the content while the image runs
    stored_at: int  # address to which the content is flashed
    content: bytes


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


def segments(file: bytes) -> list[Segment]:
    """Returns the loadable segments that have content. Raises NotElf, or NotAnImage if the file is truncated."""
    try:
        headers = [each for each in _opened(file).iter_segments("PT_LOAD") if each["p_filesz"]]
    except ELFError:
        headers = None
    if headers is None or any(each["p_offset"] + each["p_filesz"] > len(file) for each in headers):
        raise NotAnImage("is a truncated ELF file; build or copy it again")
    return [Segment(each["p_offset"], each["p_vaddr"], each["p_paddr"], each.data()) for each in headers]


def _opened(file: bytes) -> ELFFile:
    opened = ELFFile(io.BytesIO(file)) if file[:6] == b"\x7fELF\x01\x01" else None
    if opened is None or opened["e_machine"] != "EM_ARM":
        raise NotElf("is not a 32-bit little-endian ELF file for Arm; name the linked image")
    return opened


def text_of(path: Path, section: str) -> str:
    """Returns the content of a section of an object file, or "" if the object has no such section."""
    found = _opened(path.read_bytes()).get_section_by_name(section)
    return found.data().decode() if found else ""


class Elf:
    """The sections and symbols of an image."""

    def __init__(self, path: Path) -> None:
        try:
            file = _opened(path.read_bytes())
        except NotElf as error:
            raise NotElf(f"{path}: the file {error}") from None
        by_index = [self._section(section) for section in file.iter_sections()]
        self.sections = [section for section in by_index if section.allocated]
        self.symbols: list[Symbol] = []
        for section in file.iter_sections():
            if isinstance(section, SymbolTableSection):
                self._read_symbols(section, by_index)

    def word_at(self, address: int) -> int | None:
        """Returns the word at an address, or None if no loaded section contains it."""
        for section in self.sections:
            if section.loaded and section.address <= address <= section.address + section.size - 4:
                return int(struct.unpack_from("<I", section.data, address - section.address)[0])
        return None

    def named(self, name: str) -> Section | None:
        return next((section for section in self.sections if section.name == name), None)

    @staticmethod
    def _section(section) -> Section:
        allocated = bool(section["sh_flags"] & SH_FLAGS.SHF_ALLOC)
        loaded = allocated and section["sh_type"] != "SHT_NOBITS"
        return Section(section.name, section["sh_addr"], section["sh_size"], allocated,
                       bool(section["sh_flags"] & SH_FLAGS.SHF_EXECINSTR), loaded, section.data() if loaded else b"")

    def _read_symbols(self, table: SymbolTableSection, by_index: list[Section]) -> None:
        file = ""
        for symbol in table.iter_symbols():
            kind, is_local = symbol["st_info"]["type"], symbol["st_info"]["bind"] == "STB_LOCAL"
            index = symbol["st_shndx"]
            if kind == "STT_FILE":
                file = symbol.name
            elif symbol.name and not symbol.name.startswith("$"):  # AAELF32 5.5.5: $a, $d, $t only mark code and data
                self.symbols.append(Symbol(
                    name=symbol.name,
                    address=symbol["st_value"] & ~1 if kind == "STT_FUNC" else symbol["st_value"],
                    size=symbol["st_size"],
                    is_function=kind == "STT_FUNC",
                    is_object=kind == "STT_OBJECT",
                    has_type=kind != "STT_NOTYPE",
                    is_local=is_local,
                    file=file if is_local else "",
                    section=by_index[index] if isinstance(index, int) else None,
                    is_undefined=index == "SHN_UNDEF",
                ))
