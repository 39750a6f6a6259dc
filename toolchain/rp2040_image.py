"""Images for an RP2040: the checksum of the second stage, and UF2 files."""

from __future__ import annotations

import struct
from collections.abc import Iterator

FLASH = 0x10000000
SECOND_STAGE = 256  # bytes, with the checksum

_UF2_START = (0x0A324655, 0x9E5D5157)
_UF2_END = 0x0AB16F30
_UF2_HAS_FAMILY = 0x00002000
_UF2_RP2040 = 0xE48BFF56
_PAGE = 256
_BLOCK_DATA = 476  # bytes of data in a block: a page, then zeros

_LOAD = 1  # p_type


class NotAnImage(Exception):
    """The file is not an image for an RP2040."""


def checksum(data: bytes) -> int:
    """Returns the CRC-32 that the boot ROM calculates."""
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte << 24
        for _ in range(8):
            crc = (crc << 1) ^ (0x04C11DB7 if crc & 0x80000000 else 0)
        crc &= 0xFFFFFFFF
    return crc


def sealed(elf: bytes) -> bytes:
    """Returns the ELF file with the right checksum in its second stage.

    Raises NotAnImage if `elf` is not a 32-bit little-endian ELF file, or if it has no complete segment with a second
    stage. Does not check the segments after this segment.
    """
    for offset, address, data in _segments(elf):
        if address == FLASH and len(data) >= SECOND_STAGE:
            end = offset + SECOND_STAGE - 4
            crc = struct.pack("<I", checksum(elf[offset:end]))
            return elf[:end] + crc + elf[end + 4 :]
    raise NotAnImage(f"there is no second stage of {SECOND_STAGE} bytes at {FLASH:#x}; name an image for an RP2040")


def flash_content(elf: bytes) -> dict[int, bytes]:
    """Returns the pages of the flash that an ELF file uses, by address. Unused bytes of a page are FFh.

    Raises NotAnImage if `elf` is not a complete 32-bit little-endian ELF file, or if it does not use the first page.
    """
    pages: dict[int, bytearray] = {}
    for _, start, data in _segments(elf):
        for index, byte in enumerate(data):
            address = start + index
            pages.setdefault(address - address % _PAGE, bytearray(b"\xff" * _PAGE))[address % _PAGE] = byte
    if FLASH not in pages:
        raise NotAnImage(f"nothing is at the start of the flash, {FLASH:#x}; name an image for an RP2040")
    return {address: bytes(pages[address]) for address in sorted(pages)}


def uf2(elf: bytes) -> bytes:
    """Returns the UF2 file of an ELF file. Raises NotAnImage in the same cases as `flash_content`."""
    pages = flash_content(elf)
    blocks = []
    for number, (address, page) in enumerate(pages.items()):
        header = (*_UF2_START, _UF2_HAS_FAMILY, address, _PAGE, number, len(pages), _UF2_RP2040)
        blocks.append(struct.pack("<8I", *header) + page.ljust(_BLOCK_DATA, b"\0") + struct.pack("<I", _UF2_END))
    return b"".join(blocks)


def _segments(elf: bytes) -> Iterator[tuple[int, int, bytes]]:
    """Yields offset, load address and content of each loadable segment that has content.

    Raises NotAnImage if `elf` is not a complete 32-bit little-endian ELF file.
    """
    if elf[:6] != b"\x7fELF\x01\x01":
        raise NotAnImage("is not a 32-bit little-endian ELF file; name the linked image")
    try:
        offset, size, count = struct.unpack_from("<I", elf, 28)[0], *struct.unpack_from("<HH", elf, 42)
        headers = [struct.unpack_from("<5I", elf, offset + index * size) for index in range(count)]
    except struct.error:
        raise NotAnImage("is a truncated ELF file; build or copy it again") from None
    for kind, start, _, address, length in headers:
        if kind == _LOAD and length:
            if start + length > len(elf):
                raise NotAnImage("is a truncated ELF file; build or copy it again")
            yield start, address, elf[start : start + length]
