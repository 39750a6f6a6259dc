"""Finds the information about an image in the content of the flash. boards/image_info.hpp defines the fields."""

from __future__ import annotations

import struct

from elf_file import NotAnImage

# For each family of microcontrollers, the offset of the information from the first address of the flash. The linker
# scripts check this offset.
PLACES = {"Stellaris and Tiva": 0xC0, "RP2040": 0x110A8}

MARK = b"EX9INFO1"
_FIELDS = struct.Struct("<8s8s24s16s40s")


def info_of(flash: bytes) -> dict[str, str]:
    """Returns version, board, model and commit. Raises NotAnImage if the information is missing or damaged."""
    for place in PLACES.values():
        if flash[place : place + len(MARK)] == MARK:
            return _fields(flash[place : place + _FIELDS.size])
    places = " or ".join(f"{place:#x}" for place in PLACES.values())
    raise NotAnImage(f"has no information about an image at {places}; expected an image of this project")


def _fields(data: bytes) -> dict[str, str]:
    if len(data) < _FIELDS.size:
        raise NotAnImage("ends within the information about the image; build or copy it again")
    _, *fields = _FIELDS.unpack(data)
    try:
        texts = [field.rstrip(b"\0").decode("ascii") for field in fields]
    except UnicodeDecodeError:
        texts = [""]
    if not all(text.isprintable() and text for text in texts):
        raise NotAnImage("has damaged information about the image; build or copy it again")
    return dict(zip(("version", "board", "model", "commit"), texts))
