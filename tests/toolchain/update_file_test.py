"""Tests write-update, and image-info on update files."""

from __future__ import annotations

import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
from zlib import crc32

from sample import elf, hex_file, uf2

TOOLCHAIN = pathlib.Path(__file__).resolve().parents[2] / "toolchain"
sys.path.insert(0, str(TOOLCHAIN))

from elf_file import NotAnImage  # noqa: E402
from image_slot import image_in_slot  # noqa: E402
from update_file import NotAnUpdate, parse  # noqa: E402

FLASH = 0x10000000
IMAGE = bytes(range(200)) * 2  # three blocks and a part of a fourth one


def info_of(image: bytes, signature: bytes = b"9042DM.pico", version: int = 0x0123, flags: int = 0) -> bytes:
    return struct.pack(">12sIHHI8x", signature, len(image), version, flags, crc32(image))


def flash(image: bytes = IMAGE, info: bytes = b"") -> bytes:
    """Returns the content of a flash with an image in the first slot."""
    header = b"EX9SLOT1" + bytes(4) + (info or info_of(image))
    header += crc32(header).to_bytes(4, "big")
    return b"boot".ljust(0x10000, b"\xff") + header.ljust(0x1000, b"\xff") + image


def block(offset: int, data: bytes) -> bytes:
    content = offset.to_bytes(4, "big") + data.ljust(128, b"\xff")
    return content + crc32(content).to_bytes(4, "big")


def update(info: bytes = b"", image: bytes = IMAGE) -> bytes:
    """Returns an update file, written independently of the code under test."""
    blocks = [block(offset, image[offset : offset + 128]) for offset in range(0, len(image), 128)]
    return (info or info_of(IMAGE, flags=1)) + b"".join(blocks)


class Folder(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_tool(self, tool: str, *words: object) -> subprocess.CompletedProcess[str]:
        command = [str(TOOLCHAIN / tool), *map(str, words)]
        return subprocess.run(command, capture_output=True, text=True, check=False)


class WriteUpdate(Folder):
    def test_files_of_each_format_give_the_same_update(self) -> None:
        content = flash()
        files = {
            "elf": elf((FLASH, content[:0x100]), (FLASH + 0x10000, content[0x10000:])),
            "uf2": uf2(FLASH, content),
            "hex": hex_file(FLASH, content),
            "bin": content,
        }
        for kind, file in files.items():
            with self.subTest(kind):
                image = self.folder / f"image.{kind}"
                image.write_bytes(file)
                done = self.run_tool("write-update", image, self.folder / "image.ex9fw")
                self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
                self.assertEqual((self.folder / "image.ex9fw").read_bytes(), update())

    def test_a_flash_without_a_good_image_is_rejected(self) -> None:
        good = flash()
        damaged_header = bytearray(good)
        damaged_header[0x10009] ^= 1
        damaged_image = bytearray(good)
        damaged_image[0x11005] ^= 1
        for content, message in (
            (b"boot", "has no image slot at 0x10000"),
            (good[1:], "has no image slot at 0x10000"),
            (good[:0x10020], "ends within the header"),
            (bytes(damaged_header), "wrong CRC in the header"),
            (good[:-1], "ends after 399 of the 400 bytes"),
            (bytes(damaged_image), "wrong CRC of the image"),
            (flash(info=info_of(IMAGE, b"9042DM")), "has the signature '9042DM', not"),
        ):
            with self.subTest(message), self.assertRaisesRegex(NotAnImage, message):
                image_in_slot(content)

    def test_problems_are_reported_in_one_line(self) -> None:
        image = self.folder / "image.bin"
        image.write_bytes(b"text")
        done = self.run_tool("write-update", image, self.folder / "image.ex9fw")
        problem = "has no image slot at 0x10000 of the flash; name an image for a board that has slots"
        self.assertEqual((done.returncode, done.stderr), (1, f"{image}: {problem}\n"))
        self.assertFalse((self.folder / "image.ex9fw").exists())
        image.write_bytes(flash())
        done = self.run_tool("write-update", image, "/missing/image.ex9fw")
        problem = "No such file or directory; name another path"
        self.assertEqual((done.returncode, done.stderr), (1, f"/missing/image.ex9fw: {problem}\n"))
        self.assertEqual(self.run_tool("write-update", image).returncode, 2)


class ImageInfo(Folder):
    def test_it_prints_what_an_update_is(self) -> None:
        file = self.folder / "any.ex9fw"
        for signature, board, model in (
            (b"9042DM.pico", "pico", "EX9042D-M"),
            (b"9068ADM.pice", "pico-eeprom", "EX9068AD-M"),
            (b"9055D.picw", "pico-w", "EX9055D"),
            (b"9068DM.picb", "pico-relay-b", "EX9068D-M"),
            (b"9068DM.abcd", "abcd", "EX9068D-M"),
        ):
            file.write_bytes(update(info_of(IMAGE, signature)))
            done = self.run_tool("image-info", file)
            expected = f"version D01.23\nboard {board}\nmodel {model}\nlength 400\ncrc {crc32(IMAGE):08x}\n"
            self.assertEqual((done.stdout, done.stderr, done.returncode), (expected, "", 0))

    def test_it_reports_a_damaged_update_in_one_line(self) -> None:
        file = self.folder / "any.ex9fw"
        file.write_bytes(update()[:-1])
        done = self.run_tool("image-info", file)
        problem = "has 575 bytes, not 32 and 136 for each block; build or copy it again"
        self.assertEqual((done.stdout, done.stderr, done.returncode), ("", f"{file}: {problem}\n", 1))

    def test_damage_to_any_byte_is_found(self) -> None:
        good = update()
        self.assertEqual(parse(good).packed(), good)
        # Another digit makes another signature or another version.
        for place in (*range(12, 16), *range(18, len(good))):
            damaged = bytearray(good)
            damaged[place] ^= 0x10
            with self.subTest(place), self.assertRaises(NotAnUpdate):
                parse(bytes(damaged))

    def test_damage_to_each_field_is_named(self) -> None:
        def with_info(place: int, data: bytes) -> bytes:
            info = info_of(IMAGE)
            return update(info[:place] + data + info[place + len(data) :])

        for file, message in (
            (b"", "has 0 bytes"),
            (update()[:32], "has 32 bytes"),
            (with_info(0, b"x"), "signature 'x042DM.pico'"),
            (with_info(11, b"x"), "signature '9042DM.picox'"),
            (with_info(12, bytes(4)), "gives the image 0 bytes, not 1 to 126976"),
            (with_info(12, (126977).to_bytes(4, "big")), "gives the image 126977 bytes"),
            (with_info(12, (384).to_bytes(4, "big")), "has 4 blocks, not 3 for 384 bytes"),
            (with_info(12, (399).to_bytes(4, "big")), "does not end in FFh"),
            (with_info(16, b"\x01\x0a"), "version 0x010a, not decimal"),
            (with_info(18, b"\x00\x02"), "unknown flags"),
            (with_info(31, b"\x01"), "reserved byte"),
            (with_info(20, b"\x00"), "wrong CRC of the image"),
            (update()[:-1] + b"x", "wrong CRC in block 3"),
            (update()[:32] + block(128, IMAGE[:128]) + update()[168:], "offset 128 in block 0, not 0"),
            (update()[:-136] + block(384, IMAGE[384:] + b"x"), "does not end in FFh"),
            (update(image=IMAGE[::-1]), "wrong CRC of the image"),
        ):
            with self.subTest(message), self.assertRaisesRegex(NotAnUpdate, message):
                parse(file)


if __name__ == "__main__":
    unittest.main()
