"""Tests image-info on small files that these tests create. tests/boards/image_info_test.py uses real images."""

from __future__ import annotations

import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

from sample import elf, hex_file, record, uf2

TOOLCHAIN = pathlib.Path(__file__).resolve().parents[2] / "toolchain"
sys.path.insert(0, str(TOOLCHAIN))

from elf_file import NotAnImage  # noqa: E402
from image_info.flash_content import flash_content  # noqa: E402
from image_info.info import info_of  # noqa: E402

INFO = struct.pack("<8s8s24s16s40s", b"EX9INFO1", b"D01.00", b"a-board", b"EX9042D-M", b"0123abcd" * 5)
EXPECTED = {"version": "D01.00", "board": "a-board", "model": "EX9042D-M", "commit": "0123abcd" * 5}
STELLARIS = bytes(0xC0) + INFO + b"code"
PICO = bytes(0x110A8) + INFO + b"code"


class Reads(unittest.TestCase):
    def test_files_of_each_format_give_the_same_content(self) -> None:
        for content, begin in ((STELLARIS, 0), (PICO, 0x10000000)):
            files = {
                "ELF": elf((begin, content[:100]), (begin + 100, content[100:])),
                "UF2": uf2(begin, content),
                "HEX": hex_file(begin, content),
                "BIN": content,
            }
            for name, file in files.items():
                with self.subTest(name, begin=begin):
                    self.assertEqual(flash_content(file), content)
                    self.assertEqual(info_of(flash_content(file)), EXPECTED)

    def test_a_gap_is_read_as_erased_flash(self) -> None:
        self.assertEqual(flash_content(elf((0, b"ab"), (4, b"c"))), b"ab\xff\xffc")


class Rejects(unittest.TestCase):
    def refused(self, file: bytes, message: str) -> None:
        with self.assertRaisesRegex(NotAnImage, message):
            info_of(flash_content(file))

    def test_a_file_without_information_is_rejected(self) -> None:
        message = "no information about an image at 0xc0 or 0x110a8"
        for file in (b"text", bytes(1000), bytes(0xC1) + INFO, b"\x7fELF\x02\x01" + bytes(500)):
            self.refused(file, message)
        self.refused(b"", "contains no data")

    def test_a_truncated_file_is_rejected(self) -> None:
        self.refused(STELLARIS[:-20], "ends within the information")
        self.refused(elf((0, STELLARIS))[:-20], "truncated ELF file")
        self.refused(elf((0, STELLARIS))[:60], "truncated ELF file")
        self.refused(uf2(0x10000000, PICO)[:-20], "truncated UF2 file")
        self.refused(hex_file(0, STELLARIS)[:-13], "truncated HEX file")

    def test_a_damaged_file_is_rejected(self) -> None:
        self.refused(STELLARIS.replace(b"a-board", b"a\xffboard"), "damaged information")
        self.refused(STELLARIS.replace(b"a-board", bytes(7)), "damaged information")
        self.refused(uf2(0, PICO)[:512] + bytes(512), "block 1 is not a UF2 block")
        good = hex_file(0, STELLARIS)
        self.refused(good.replace(b"45583949", b"45583948", 1), "line 14 has a wrong checksum")
        self.refused(good.replace(b":", b":0", 1), "line 1 is not a record")
        self.refused(record(7, 0, b"") + good, "record type 7")

    def test_content_that_spans_more_than_16_mib_is_rejected(self) -> None:
        self.refused(elf((0, b"a"), (0x20000000, b"b")), "at most 16 MiB")


class Program(unittest.TestCase):
    def run_on(self, *words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([str(TOOLCHAIN / "image-info"), *words], capture_output=True, text=True, check=False)

    def test_it_prints_four_lines(self) -> None:
        with tempfile.NamedTemporaryFile() as file:
            file.write(PICO)
            file.flush()
            done = self.run_on(file.name)
        self.assertEqual(done.stdout, "".join(f"{name} {text}\n" for name, text in EXPECTED.items()))
        self.assertEqual(done.returncode, 0)

    def test_it_reports_a_wrong_file_in_one_line_and_rejects_a_call_without_a_file(self) -> None:
        missing = self.run_on("/missing.bin")
        self.assertEqual(missing.stderr, "/missing.bin: No such file or directory; name a file that you can read\n")
        self.assertEqual(missing.returncode, 1)
        wrong = self.run_on(__file__)
        self.assertRegex(wrong.stderr, f"^{__file__}: has no information about an image .*; expected .*\n$")
        self.assertEqual((wrong.returncode, wrong.stdout), (1, ""))
        self.assertEqual(self.run_on().returncode, 2)


if __name__ == "__main__":
    unittest.main()
