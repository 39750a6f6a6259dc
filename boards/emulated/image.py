"""Reads an image file and checks that the image is for the expected board."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

from elf_file import NotAnImage, NotElf, Segment, segments
from emulated.refusal import Refusal


@dataclass(frozen=True)
class Memory:
    """A preset of a board, and two addresses that depend on the memory regions in the board's image.ld."""

    preset: str
    vectors: int  # address of the vector table
    top_of_ram: int  # first address after the RAM


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
        found = segments(file)
    except NotElf as error:
        raise Refusal(
            f"{path}: the file is not an ELF file for Arm; name MODEL.elf, not MODEL.bin or MODEL.hex") from error
    except NotAnImage as error:
        raise Refusal(f"{path}: the file is incomplete; build the image again") from error
    # The first word of the vector table is the initial stack pointer. In an image, this is the top of the RAM.
    if _word_at(found, memory.vectors) != memory.top_of_ram:
        raise Refusal(f"{path}: the image is for another board; name an image of the preset {memory.preset}")
    return found


def _word_at(found: list[Segment], address: int) -> int | None:
    """Returns the word at an address, or None if no segment of at least four bytes begins at this address."""
    for segment in found:
        if segment.address == address and len(segment.content) >= 4:
            return int(struct.unpack_from("<I", segment.content)[0])
    return None
