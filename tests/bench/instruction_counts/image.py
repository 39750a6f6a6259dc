"""Reads a firmware image: its vectors, and where it sleeps."""

import pathlib
import struct

from elf_file import Elf, NotAnImage
from instruction_counts.refusal import Refusal

WFI = bytes.fromhex("30BF")


class Image:
    def __init__(self, path):
        try:
            self._elf = Elf(pathlib.Path(path))
        except NotAnImage as error:
            raise Refusal(str(error)) from error

    def handlers(self):
        """Returns the address of the first instruction of each exception handler, by exception number."""
        words = [word for word, in struct.iter_unpack("<I", self._elf.named(".vectors").data)]
        return {number: word & ~1 for number, word in enumerate(words) if number >= 1}

    def sleeps(self):
        """Returns the addresses of the WFI instructions, where the main loop sleeps. A literal with the same value does
        no harm, because it is not executed."""
        return {section.address + at for section in self._elf.sections if section.executable
                for at in range(0, section.size, 2) if section.data[at:at + 2] == WFI}
