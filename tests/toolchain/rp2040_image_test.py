"""Tests the checksum of the second stage and the header of the slot in images for an RP2040, and UF2 files."""

from __future__ import annotations

import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

from sample import elf

TOOLCHAIN = pathlib.Path(__file__).resolve().parents[2] / "toolchain"
sys.path.insert(0, str(TOOLCHAIN))

from elf_file import NotAnImage  # noqa: E402
from rp2040_image import FLASH, checksum, flash_content, sealed, uf2  # noqa: E402

PAGE = 256
BLOCK = 512
SECTOR = 4096
SLOT = FLASH + 0x10000

STAGE = bytes(range(252)) + bytes(4)
HEAD = b"EX9SLOT1" + bytes(range(1, 121))
IMAGE = (SLOT + SECTOR, b"image")


def seal(*segments: tuple[int, bytes]) -> dict[int, bytes]:
    return flash_content(sealed(elf(*segments)))


class SecondStage(unittest.TestCase):
    def test_the_checksum_is_crc_32_mpeg_2(self) -> None:
        # The data sheet of the RP2040 requires CRC-32/MPEG-2. The check value of this CRC is 0x0376E6E7.
        self.assertEqual(checksum(b"123456789"), 0x0376E6E7)

    def test_the_last_four_bytes_become_the_checksum_of_the_252_bytes_before_them(self) -> None:
        before = elf((FLASH, STAGE), (SLOT, HEAD), IMAGE)
        after = sealed(before)
        stage = flash_content(after)[FLASH]
        self.assertEqual(struct.unpack("<I", stage[252:])[0], checksum(STAGE[:252]))
        self.assertEqual(stage[:252], STAGE[:252])
        self.assertEqual(len(after), len(before))
        self.assertEqual(sealed(after), after)

    def test_a_file_without_a_second_stage_is_rejected(self) -> None:
        for file in (elf((FLASH, b"short"), (SLOT, HEAD), IMAGE), elf((FLASH + 256, STAGE), (SLOT, HEAD), IMAGE)):
            with self.assertRaisesRegex(NotAnImage, "no second stage"):
                sealed(file)
        with self.assertRaises(NotAnImage):
            sealed(b"text")


class Slot(unittest.TestCase):
    def test_the_header_gets_length_and_crc_of_the_image_and_its_own_crc(self) -> None:
        # The image has two segments, and its bytes are the check value of CRC-32: 0xCBF43926.
        parts = (SLOT + SECTOR + 4, b"56789"), (SLOT + SECTOR, b"1234")
        head = seal((FLASH, STAGE), (SLOT, HEAD), *parts, (SLOT + 0x20000, b"other"))[SLOT]
        self.assertEqual(head[24:28], struct.pack(">I", 9))
        self.assertEqual(head[32:36], struct.pack(">I", 0xCBF43926))
        self.assertEqual(head[44:48], struct.pack(">I", zlib.crc32(head[:44])))
        for begin, end in ((0, 24), (28, 32), (36, 44), (48, 128)):
            self.assertEqual(head[begin:end], HEAD[begin:end])

    def test_a_file_without_a_slot_or_an_image_is_rejected(self) -> None:
        with self.assertRaisesRegex(NotAnImage, "no slot"):
            seal((FLASH, STAGE), IMAGE)
        with self.assertRaisesRegex(NotAnImage, "no image"):
            seal((FLASH, STAGE), (SLOT, HEAD))


class Uf2(unittest.TestCase):
    def blocks(self, file: bytes) -> list[bytes]:
        self.assertEqual(len(file) % BLOCK, 0)
        return [file[start : start + BLOCK] for start in range(0, len(file), BLOCK)]

    def test_each_block_has_its_number_and_a_page_and_the_address_of_this_page(self) -> None:
        image = bytes(range(256)) + b"abc"
        blocks = self.blocks(uf2(elf((FLASH, STAGE), (FLASH + 256, image))))
        self.assertEqual(len(blocks), SECTOR // PAGE)
        for number, block in enumerate(blocks):
            fields = struct.unpack_from("<8I", block)
            expected = (0x0A324655, 0x9E5D5157, 0x2000, FLASH + PAGE * number, PAGE, number, len(blocks), 0xE48BFF56)
            self.assertEqual(fields, expected)
            self.assertEqual(struct.unpack("<I", block[-4:])[0], 0x0AB16F30)
            self.assertEqual(block[32 + PAGE : -4], bytes(476 - PAGE))
        self.assertEqual(blocks[1][32 : 32 + PAGE], bytes(range(256)))
        self.assertEqual(blocks[2][32 : 32 + PAGE], b"abc".ljust(PAGE, b"\xff"))

    def test_the_file_has_whole_sectors_and_only_those_that_the_image_uses(self) -> None:
        blocks = self.blocks(uf2(elf((FLASH, STAGE), (FLASH + 0x5110, b"x"))))
        expected = [*range(FLASH, FLASH + SECTOR, PAGE), *range(FLASH + 0x5000, FLASH + 0x6000, PAGE)]
        self.assertEqual([struct.unpack_from("<4I", block)[3] for block in blocks], expected)
        self.assertEqual(blocks[17][32:49], b"\xff" * 16 + b"x")

    def test_a_truncated_file_is_rejected(self) -> None:
        whole = elf((FLASH, STAGE), (FLASH + 0x1010, b"x"))
        for size in (50, len(whole) - 1):
            with self.subTest(size), self.assertRaisesRegex(NotAnImage, "is a truncated ELF file"):
                uf2(whole[:size])

    def test_the_programs_report_a_wrong_file_in_one_line(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            image = pathlib.Path(folder, "image.elf")
            image.write_bytes(b"no image")
            for words in (["seal-image", image], ["write-uf2", image, image.with_suffix(".uf2")]):
                done = subprocess.run(
                    [str(TOOLCHAIN / words[0]), *map(str, words[1:])], capture_output=True, text=True, check=False
                )
                self.assertEqual(done.returncode, 1)
                problem = "is not a 32-bit little-endian ELF file for Arm; name the linked image"
                self.assertEqual(done.stderr, f"{image}: {problem}\n")


if __name__ == "__main__":
    unittest.main()
