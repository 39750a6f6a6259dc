"""Update files, NAME.ex9fw: an image in the form in which a master writes it to a module over the line.

First in the file is what a master writes to the registers from 0x1000 on, 32 bytes, and then each block for those from
0x2000 on, 136 bytes. firmware/extensions.md describes the registers, under "Firmware update".
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass
from zlib import crc32

INFO_SIZE = 32
BLOCK_SIZE = 136
DATA_SIZE = 128  # bytes of the image in a block
LARGEST_IMAGE = 31 * 4096
ACTIVATE_WHEN_COMPLETE = 1  # the only flag

# The preset of a board, by its code in a signature.
BOARDS = {"pico": "pico", "pice": "pico-eeprom", "picw": "pico-w", "picb": "pico-relay-b"}

_INFO = struct.Struct(">12sIHHI8s")
_BLOCK = struct.Struct(">I128sI")
_SIGNATURE = re.compile(r"([0-9]{4}[A-Z]*?)(M?)\.([a-z0-9]{1,4})")
_AGAIN = "build or copy it again"


class NotAnUpdate(Exception):
    """The data is damaged, or it is not an update of a module."""


@dataclass(frozen=True)
class Info:
    """The information block."""

    signature: str  # of the modules that the image is for, for example 9042DM.pico
    length: int  # of the image, in bytes
    version: int  # nn.nn in BCD
    flags: int
    check: int  # CRC-32 of the image

    @classmethod
    def read(cls, data: bytes) -> Info:
        """Raises NotAnUpdate if a field has a value that no image has."""
        signature, length, version, flags, check, reserved = _INFO.unpack(data)
        text = signature.rstrip(b"\0").decode("latin-1")
        if not _SIGNATURE.fullmatch(text):
            raise NotAnUpdate(f"has the signature {text!r}, not one like '9042DM.pico'; {_AGAIN}")
        if not 0 < length <= LARGEST_IMAGE:
            raise NotAnUpdate(f"gives the image {length} bytes, not 1 to {LARGEST_IMAGE}; {_AGAIN}")
        if not f"{version:04x}".isdecimal():
            raise NotAnUpdate(f"has the version {version:#06x}, not decimal digits as 0x0100; {_AGAIN}")
        if flags & ~ACTIVATE_WHEN_COMPLETE or any(reserved):
            raise NotAnUpdate(f"has unknown flags or a reserved byte that is not 0; {_AGAIN}")
        return cls(text, length, version, flags, check)

    def packed(self) -> bytes:
        return _INFO.pack(self.signature.encode(), self.length, self.version, self.flags, self.check, bytes(8))

    @property
    def model(self) -> str:
        return _SIGNATURE.sub(lambda match: f"EX{match[1]}{'-M' if match[2] else ''}", self.signature)

    @property
    def board(self) -> str:
        code = self.signature.partition(".")[2]
        return BOARDS.get(code, code)


@dataclass(frozen=True)
class Update:
    info: Info
    blocks: list[bytes]

    def packed(self) -> bytes:
        return self.info.packed() + b"".join(self.blocks)


def version_text(version: int) -> str:
    """Returns a version as a module names it in `$AAF`."""
    return f"D{version >> 8:02x}.{version & 0xFF:02x}"


def update_of(info: Info, image: bytes) -> Update:
    """Returns the update with an image, which must have the length and the CRC in `info`."""
    blocks = []
    for offset in range(0, len(image), DATA_SIZE):
        data = image[offset : offset + DATA_SIZE].ljust(DATA_SIZE, b"\xff")
        blocks.append(_BLOCK.pack(offset, data, crc32(offset.to_bytes(4, "big") + data)))
    return Update(info, blocks)


def parse(file: bytes) -> Update:
    """Raises NotAnUpdate if the file is damaged."""
    count, rest = divmod(len(file) - INFO_SIZE, BLOCK_SIZE)
    if count < 1 or rest:
        raise NotAnUpdate(f"has {len(file)} bytes, not {INFO_SIZE} and {BLOCK_SIZE} for each block; {_AGAIN}")
    info = Info.read(file[:INFO_SIZE])
    expected = -(-info.length // DATA_SIZE)
    if count != expected:
        raise NotAnUpdate(f"has {count} blocks, not {expected} for {info.length} bytes; {_AGAIN}")
    blocks = [file[start : start + BLOCK_SIZE] for start in range(INFO_SIZE, len(file), BLOCK_SIZE)]
    image = b""
    for number, block in enumerate(blocks):
        offset, data, check = _BLOCK.unpack(block)
        if check != crc32(block[:-4]):
            raise NotAnUpdate(f"has a wrong CRC in block {number}; {_AGAIN}")
        if offset != len(image):
            raise NotAnUpdate(f"has the offset {offset} in block {number}, not {len(image)}; {_AGAIN}")
        image += data
    if image[info.length :].strip(b"\xff"):
        raise NotAnUpdate(f"does not end in FFh after the image; {_AGAIN}")
    if info.check != crc32(image[: info.length]):
        raise NotAnUpdate(f"has a wrong CRC of the image; {_AGAIN}")
    return Update(info, blocks)
