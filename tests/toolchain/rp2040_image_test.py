"""Tests the checksum of the second stage in images for an RP2040, and the UF2 files of such images."""

from __future__ import annotations

import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

from sample import elf

TOOLCHAIN = pathlib.Path(__file__).resolve().parents[2] / "toolchain"
sys.path.insert(0, str(TOOLCHAIN))

from elf_file import NotAnImage  # noqa: E402
from rp2040_image import FLASH, checksum, flash_content, sealed, uf2  # noqa: E402

PAGE = 256
BLOCK = 512


STAGE = bytes(range(252)) + bytes(4)


class SecondStage(unittest.TestCase):
    def test_the_checksum_is_crc_32_mpeg_2(self) -> None:
        # The data sheet of the RP2040 requires CRC-32/MPEG-2. The check value of this CRC is 0x0376E6E7.
        self.assertEqual(checksum(b"123456789"), 0x0376E6E7)

    def test_the_last_four_bytes_become_the_checksum_of_the_252_bytes_before_them(self) -> None:
        before = elf((FLASH, STAGE), (FLASH + 256, b"image"))
        after = sealed(before)
        stage = flash_content(after)[FLASH]
        self.assertEqual(struct.unpack("<I", stage[252:])[0], checksum(STAGE[:252]))
        self.assertEqual(stage[:252], STAGE[:252])
        self.assertEqual(len(after), len(before))
        self.assertEqual(sealed(after), after)

    def test_a_file_without_a_second_stage_is_rejected(self) -> None:
        for file in (elf((FLASH, b"short")), elf((FLASH + 256, STAGE)), b"text"):
            with self.assertRaises(NotAnImage):
                sealed(file)


class Uf2(unittest.TestCase):
    def blocks(self, file: bytes) -> list[bytes]:
        self.assertEqual(len(file) % BLOCK, 0)
        return [file[start : start + BLOCK] for start in range(0, len(file), BLOCK)]

    def test_each_block_has_its_number_and_a_page_and_the_address_of_this_page(self) -> None:
        image = bytes(range(256)) + b"abc"
        blocks = self.blocks(uf2(elf((FLASH, STAGE), (FLASH + 256, image))))
        self.assertEqual(len(blocks), 3)
        for number, block in enumerate(blocks):
            fields = struct.unpack_from("<8I", block)
            expected = (0x0A324655, 0x9E5D5157, 0x2000, FLASH + PAGE * number, PAGE, number, 3, 0xE48BFF56)
            self.assertEqual(fields, expected)
            self.assertEqual(struct.unpack("<I", block[-4:])[0], 0x0AB16F30)
            self.assertEqual(block[32 + PAGE : -4], bytes(476 - PAGE))
        self.assertEqual(blocks[1][32 : 32 + PAGE], bytes(range(256)))
        self.assertEqual(blocks[2][32 : 32 + PAGE], b"abc".ljust(PAGE, b"\xff"))

    def test_pages_that_the_image_does_not_use_are_not_in_the_file(self) -> None:
        blocks = self.blocks(uf2(elf((FLASH, STAGE), (FLASH + 0x1010, b"x"))))
        self.assertEqual([struct.unpack_from("<4I", block)[3] for block in blocks], [FLASH, FLASH + 0x1000])
        self.assertEqual(blocks[1][32:49], b"\xff" * 16 + b"x")

    def test_a_truncated_file_is_rejected(self) -> None:
        whole = elf((FLASH, STAGE), (FLASH + 0x1010, b"x"))
        for size in (50, len(whole) - 1):
            with self.subTest(size), self.assertRaisesRegex(NotAnImage, "is a truncated ELF file"):
                uf2(whole[:size])

    def test_the_programs_report_a_wrong_file_in_one_line(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            image = pathlib.Path(folder, "image.elf")
            image.write_bytes(b"no image")
            for words in (["seal-second-stage", image], ["write-uf2", image, image.with_suffix(".uf2")]):
                done = subprocess.run(
                    [str(TOOLCHAIN / words[0]), *map(str, words[1:])], capture_output=True, text=True, check=False
                )
                self.assertEqual(done.returncode, 1)
                problem = "is not a 32-bit little-endian ELF file for Arm; name the linked image"
                self.assertEqual(done.stderr, f"{image}: {problem}\n")


if __name__ == "__main__":
    unittest.main()
