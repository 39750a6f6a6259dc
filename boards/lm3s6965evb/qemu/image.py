"""Checks that a file is an ELF image for this board."""

from __future__ import annotations

import struct
from pathlib import Path

from qemu.refusal import Refusal

_ARM = 40
_LOADED = 1  # PT_LOAD
_TOP_OF_RAM = 0x20010000  # the end of the RAM in image.ld; the stack of each image begins there


def check(path: Path) -> None:
    """Raises Refusal if the file is not an ELF image for this board.

    QEMU starts any file. Without this check, the error would appear only after 60 s, if the UART is then still off.
    """
    try:
        file = path.read_bytes()
    except OSError as error:
        raise Refusal(
            f"{path}: {error.strerror}; build an image with `cmake --build --preset lm3s6965evb`"
        ) from error
    if file[:5] != b"\x7fELF\x01" or struct.unpack_from("<H", file, 18)[0] != _ARM:
        raise Refusal(f"{path}: the file is not an ELF file for Arm; name MODEL.elf, not MODEL.bin or MODEL.hex")
    if _initial_stack_pointer(file) != _TOP_OF_RAM:
        raise Refusal(f"{path}: the image is for another board; name an image of the preset lm3s6965evb")


def _initial_stack_pointer(file: bytes) -> int | None:
    """Returns the word at address 0, which the processor reads first, or None if the file has no such word."""
    (headers,) = struct.unpack_from("<I", file, 28)
    size, count = struct.unpack_from("<HH", file, 42)
    for index in range(count):
        kind, offset, _, address = struct.unpack_from("<IIII", file, headers + index * size)
        if kind == _LOADED and address == 0:
            return int(struct.unpack_from("<I", file, offset)[0])
    return None
