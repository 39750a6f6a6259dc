"""Tests that toolchain/image-info reads the description of an image from every file format of the build."""

from __future__ import annotations

import re
import subprocess
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FORMATS = ("elf", "hex", "bin", "uf2")
# For each preset, a model that tests/images builds.
MODELS = {
    **dict.fromkeys(("lm3s6965evb", "ek-tm4c123gxl", "ek-tm4c123gxl-usb", "pico", "pico-eeprom", "pico-w"), "EX9055D"),
    "pico-relay-b": "EX9068D-M",
}


def firmware_version() -> str:
    match = re.search(r'kFirmwareVersion = "([^"]+)"', (ROOT / "firmware/model/model.hpp").read_text("utf-8"))
    assert match
    return match[1]


class ImageInfo(unittest.TestCase):
    def test_image_info_prints_version_board_model_and_commit_of_each_file(self) -> None:
        version = firmware_version()
        for preset, model in MODELS.items():
            files = [ROOT / "build" / preset / f"{model}.{kind}" for kind in FORMATS]
            files = [file for file in files if file.suffix != ".uf2" or preset.startswith("pico")]
            for file in files:
                with self.subTest(file=str(file.relative_to(ROOT))):
                    done = subprocess.run(
                        [ROOT / "toolchain/image-info", file], capture_output=True, text=True, check=False
                    )
                    expected = f"version {version}\nboard {preset}\nmodel {model}\ncommit development\n"
                    self.assertEqual((done.stdout, done.stderr), (expected, ""))


if __name__ == "__main__":
    unittest.main()
