"""Images for an RP2040: the checksum of the second stage, the header of the slot, and UF2 files."""

from __future__ import annotations

import struct
import zlib

from elf_file import NotAnImage, Segment, segments

FLASH = 0x10000000
SECOND_STAGE = 256  # bytes, with the checksum

# Of the slot and its header: firmware/update/slot.hpp.
SLOT_MAGIC = b"EX9SLOT1"
IMAGE_IN_SLOT = 4096
_LENGTH_AT = 24
_CRC_AT = 32
_CHECK_AT = 44

_UF2_START = (0x0A324655, 0x9E5D5157)
_UF2_END = 0x0AB16F30
_UF2_HAS_FAMILY = 0x00002000
_UF2_RP2040 = 0xE48BFF56
_PAGE = 256
_SECTOR = 4096
_BLOCK_DATA = 476  # bytes of data in a block: a page, then zeros


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
    """Returns the ELF file with the right checksum in its second stage, and with the right header of its slot.

    Raises NotAnImage if `elf` is not a 32-bit little-endian ELF file, or if it has no complete segment with a second
    stage, no header, or no image.
    """
    return _with_header(_with_checksum(elf))


def _with_checksum(elf: bytes) -> bytes:
    for segment in segments(elf):
        if segment.stored_at == FLASH and len(segment.content) >= SECOND_STAGE:
            end = segment.offset + SECOND_STAGE - 4
            crc = struct.pack("<I", checksum(elf[segment.offset : end]))
            return elf[:end] + crc + elf[end + 4 :]
    raise NotAnImage(f"there is no second stage of {SECOND_STAGE} bytes at {FLASH:#x}; name an image for an RP2040")


def _with_header(elf: bytes) -> bytes:
    for segment in segments(elf):
        if segment.content.startswith(SLOT_MAGIC):
            image = _image_at(segment.stored_at + IMAGE_IN_SLOT, segments(elf))
            header = bytearray(segment.content)
            struct.pack_into(">I", header, _LENGTH_AT, len(image))
            struct.pack_into(">I", header, _CRC_AT, zlib.crc32(image))
            struct.pack_into(">I", header, _CHECK_AT, zlib.crc32(header[:_CHECK_AT]))
            return elf[: segment.offset] + bytes(header) + elf[segment.offset + len(header) :]
    raise NotAnImage("there is no slot with an image; name an image for an RP2040")


def _image_at(address: int, found: list[Segment]) -> bytes:
    """Returns the content of the segments that follow each other from `address` on."""
    image = b""
    for segment in sorted(found, key=lambda each: each.stored_at):
        if segment.stored_at == address + len(image):
            image += segment.content
    if not image:
        raise NotAnImage(f"there is no image at {address:#x}; name an image for an RP2040")
    return image


def flash_content(elf: bytes) -> dict[int, bytes]:
    """Returns all pages of the flash sectors that an ELF file uses, by address. Unused bytes are FFh. The boot ROM may
    lose pages of a UF2 file that has only some pages of a sector (erratum RP2040-E14).

    Raises NotAnImage if `elf` is not a complete 32-bit little-endian ELF file, or if it does not use the first page.
    """
    pages: dict[int, bytearray] = {}
    for segment in segments(elf):
        for address, byte in enumerate(segment.content, start=segment.stored_at):
            if address - address % _PAGE not in pages:
                sector = address - address % _SECTOR
                pages.update({page: bytearray(b"\xff" * _PAGE) for page in range(sector, sector + _SECTOR, _PAGE)})
            pages[address - address % _PAGE][address % _PAGE] = byte
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
