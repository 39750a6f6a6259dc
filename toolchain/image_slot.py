"""Finds the image in the first slot of a flash. firmware/update/slot.hpp describes a slot."""

from __future__ import annotations

import struct
from zlib import crc32

from elf_file import NotAnImage
from rp2040_image import IMAGE_IN_SLOT, SLOT_MAGIC
from update_file import Info, NotAnUpdate

SLOT = 0x10000  # from the start of the flash
IMAGE = SLOT + IMAGE_IN_SLOT
HEADER = struct.Struct(">8sI32sI")  # magic, sequence number, information block, CRC-32 of these


def image_in_slot(flash: bytes) -> tuple[Info, bytes]:
    """Returns the information block and the image. Raises NotAnImage if the slot is empty or damaged."""
    header = flash[SLOT : SLOT + HEADER.size]
    if not header.startswith(SLOT_MAGIC):
        raise NotAnImage(f"has no image slot at {SLOT:#x} of the flash; name an image for a board that has slots")
    if len(header) < HEADER.size:
        raise NotAnImage("ends within the header of the image slot; build or copy it again")
    _, _, data, check = HEADER.unpack(header)
    if check != crc32(header[:-4]):
        raise NotAnImage("has a wrong CRC in the header of the image slot; build or copy it again")
    try:
        info = Info.read(data)
    except NotAnUpdate as error:
        raise NotAnImage(str(error)) from error
    image = flash[IMAGE : IMAGE + info.length]
    if len(image) < info.length:
        raise NotAnImage(f"ends after {len(image)} of the {info.length} bytes of the image; build or copy it again")
    if info.check != crc32(image):
        raise NotAnImage("has a wrong CRC of the image; build or copy it again")
    return info, image
