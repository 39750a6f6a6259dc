"""Reads an image file and checks that the image is for the expected board."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Iterator

from emulated.refusal import Refusal

_ARM = 40
_LOADED = 1  # PT_LOAD


@dataclass(frozen=True)
class Memory:
    """A preset of a board, and two addresses that depend on the memory regions in the board's image.ld."""

    preset: str
    vectors: int  # address of the vector table
    top_of_ram: int  # first address after the RAM


@dataclass(frozen=True)
class Segment:
    address: int  # address of the content while the image runs
    stored_at: int  # address to which the content is flashed
    content: bytes


def read(path: Path, memory: Memory) -> list[Segment]:
    """Returns the loadable segments of the image file `path`, except empty segments.

    Raises Refusal if the file cannot be read, is not an ELF file for Arm, ends inside its headers or inside a segment,
    or is not an image for the board of `memory`. The emulators do not check that an image is for their board. Without
    the check in this function, QEMU could run a wrong file for 60 s before the program `run` reports an error. If the
    wrong file enabled the UART within this time, `run` would not report an error.
    """
    try:
        file = path.read_bytes()
    except OSError as error:
        raise Refusal(
            f"{path}: {error.strerror}; build an image with `cmake --build --preset {memory.preset}`"
        ) from error
    try:
        if file[:5] != b"\x7fELF\x01" or struct.unpack_from("<H", file, 18)[0] != _ARM:
            raise Refusal(f"{path}: the file is not an ELF file for Arm; name MODEL.elf, not MODEL.bin or MODEL.hex")
        segments = list(_segments(file))
    except struct.error as error:
        raise Refusal(f"{path}: the file is incomplete; build the image again") from error
    # The first word of the vector table is the initial stack pointer. In an image, this is the top of the RAM.
    if _word_at(segments, memory.vectors) != memory.top_of_ram:
        raise Refusal(f"{path}: the image is for another board; name an image of the preset {memory.preset}")
    return segments


def _segments(file: bytes) -> Iterator[Segment]:
    (headers,) = struct.unpack_from("<I", file, 28)
    size, count = struct.unpack_from("<HH", file, 42)
    for index in range(count):
        kind, offset, address, stored_at, stored = struct.unpack_from("<5I", file, headers + index * size)
        if kind == _LOADED and stored != 0:
            if offset + stored > len(file):
                raise struct.error("a segment ends beyond the end of the file")
            yield Segment(address, stored_at, file[offset : offset + stored])


def _word_at(segments: list[Segment], address: int) -> int | None:
    """Returns the word at an address, or None if no segment of at least four bytes begins at this address."""
    for segment in segments:
        if segment.address == address and len(segment.content) >= 4:
            return int(struct.unpack_from("<I", segment.content)[0])
    return None
