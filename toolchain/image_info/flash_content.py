"""Reads the content of the flash from an image in any of the formats that a build writes."""

from __future__ import annotations

import struct

from elf_file import NotAnImage, segments

_ELF = b"\x7fELF\x01\x01"
_UF2 = struct.pack("<2I", 0x0A324655, 0x9E5D5157)
_UF2_BLOCK = 512
_UF2_DATA = 476  # the largest number of data bytes in a block
_HEX_DATA, _HEX_END, _HEX_SEGMENT, _HEX_START_SEGMENT, _HEX_LINEAR, _HEX_START_LINEAR = range(6)


def flash_content(file: bytes) -> bytes:
    """Returns the bytes of the flash from its first used address on. Gaps are FFh, as in an erased flash.

    Raises NotAnImage if the file is damaged, contains no data, or extends over more than 16 MiB of flash.
    """
    if file.startswith(_ELF):
        pieces = [(segment.stored_at, segment.content) for segment in segments(file)]
    elif file.startswith(_UF2):
        pieces = _uf2(file)
    elif file.startswith(b":"):
        pieces = _hex(file)
    else:
        pieces = [(0, file)]
    return _joined(pieces)


def _joined(pieces: list[tuple[int, bytes]]) -> bytes:
    pieces = [(address, data) for address, data in pieces if data]
    if not pieces:
        raise NotAnImage("contains no data; expected a firmware image")
    begin = min(address for address, _ in pieces)
    size = max(address + len(data) for address, data in pieces) - begin
    if size > 0x1000000:
        raise NotAnImage(
            f"extends over {size} bytes from {begin:#x} on; expected an image for a flash of at most 16 MiB"
        )
    content = bytearray(b"\xff" * size)
    for address, data in pieces:
        content[address - begin : address - begin + len(data)] = data
    return bytes(content)


def _uf2(file: bytes) -> list[tuple[int, bytes]]:
    if len(file) % _UF2_BLOCK:
        raise NotAnImage(f"is a truncated UF2 file; expected blocks of {_UF2_BLOCK} bytes")
    pieces = []
    for begin in range(0, len(file), _UF2_BLOCK):
        block = file[begin : begin + _UF2_BLOCK]
        address, length = struct.unpack_from("<2I", block, 12)
        if not block.startswith(_UF2) or length > _UF2_DATA:
            raise NotAnImage(f"is damaged: block {begin // _UF2_BLOCK} is not a UF2 block; build or copy it again")
        pieces.append((address, block[32 : 32 + length]))
    return pieces


def _hex(file: bytes) -> list[tuple[int, bytes]]:
    pieces = []
    base = 0
    for number, line in enumerate(file.split(b"\n"), start=1):
        line = line.strip()
        if not line:
            continue
        kind, address, data = _hex_record(line, number)
        if kind == _HEX_DATA:
            pieces.append((base + address, data))
        elif kind == _HEX_END:
            return pieces
        elif kind in (_HEX_SEGMENT, _HEX_LINEAR):
            base = int.from_bytes(data, "big") << (4 if kind == _HEX_SEGMENT else 16)
        elif kind not in (_HEX_START_SEGMENT, _HEX_START_LINEAR):
            raise NotAnImage(f"line {number} has the record type {kind}; expected 0 to 5")
    raise NotAnImage("is a truncated HEX file: the end record is missing; build or copy it again")


def _hex_record(line: bytes, number: int) -> tuple[int, int, bytes]:
    """Returns the type, the address and the data of a record. Raises NotAnImage if the record is damaged."""
    try:
        record = bytes.fromhex(line[1:].decode("ascii"))
    except ValueError:
        record = b""
    if line[:1] != b":" or len(record) < 5 or len(record) != record[0] + 5:
        raise NotAnImage(f"line {number} is not a record of a HEX file; build or copy it again")
    if sum(record) % 256:
        raise NotAnImage(f"line {number} has a wrong checksum; build or copy it again")
    return record[3], int.from_bytes(record[1:3], "big"), record[4:-1]
