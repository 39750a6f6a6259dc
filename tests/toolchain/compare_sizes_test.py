"""Tests compare-sizes: the sizes that it accepts, rejects and records."""

from __future__ import annotations

import subprocess
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(__file__).resolve().parents[2] / "toolchain" / "compare-sizes"


class CompareSizes(unittest.TestCase):
    """When a test starts, the record has a line for one image: 1000 bytes of flash, 200 of static RAM, 100 of stack."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.built = Path(folder.name)
        self.record = self.built / "record"
        self.record.write_text("board IMAGE 1000 200 100\n", encoding="utf-8")

    def compare(self, line: str, *options: str) -> subprocess.CompletedProcess[str]:
        (self.built / "IMAGE.size").write_text(f"{line}\n", encoding="utf-8")
        command = [str(PROGRAM), "--file", str(self.record), *options, str(self.built)]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def test_growth_by_five_percent_is_accepted(self) -> None:
        compared = self.compare("board IMAGE 1050 215 100")
        self.assertEqual((compared.returncode, compared.stderr), (0, ""))

    def test_growth_of_the_flash_by_more_than_five_percent_is_rejected_and_printed(self) -> None:
        compared = self.compare("board IMAGE 1051 200 100")
        self.assertEqual(compared.returncode, 1)
        grown = "board IMAGE: has grown by more than 5 %: flash 1051 (+51), static 200, stack 100"
        self.assertIn(grown, compared.stderr)

    def test_the_sum_of_static_ram_and_stack_is_compared(self) -> None:
        self.assertEqual(self.compare("board IMAGE 1000 100 215").returncode, 0)
        self.assertEqual(self.compare("board IMAGE 1000 200 116").returncode, 1)

    def test_an_image_that_is_not_in_the_record_is_rejected(self) -> None:
        compared = self.compare("board OTHER 1 1 1")
        self.assertEqual(compared.returncode, 1)
        self.assertIn("board OTHER: is not in the record", compared.stderr)

    def test_a_folder_without_sizes_is_rejected_and_the_record_does_not_change(self) -> None:
        with tempfile.TemporaryDirectory() as empty:
            command = [str(PROGRAM), "--file", str(self.record), "--record", empty]
            compared = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(compared.returncode, 2)
        self.assertIn("contains no sizes of images", compared.stderr)
        self.assertEqual(self.record.read_text(encoding="utf-8"), "board IMAGE 1000 200 100\n")

    def test_a_new_record_has_the_sizes_of_the_build_and_accepts_them(self) -> None:
        self.assertEqual(self.compare("board IMAGE 2000 400 300", "--record").returncode, 0)
        self.assertEqual(self.record.read_text(encoding="utf-8"), "board IMAGE 2000 400 300\n")
        self.assertEqual(self.compare("board IMAGE 2000 400 300").returncode, 0)


if __name__ == "__main__":
    unittest.main()
