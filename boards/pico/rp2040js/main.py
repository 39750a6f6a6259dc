"""The program boards/pico/run."""

from __future__ import annotations

from pathlib import Path

from elf_file import NotAnImage
from emulated import image, memory_file, program
from image_info.info import info_of
from rp2040js.machine import Machine

_BOARD = image.Memory(preset="pico", vectors=0x20000000, top_of_ram=0x20040000)
_FLASH = 0x10000000
_IMAGE_SIZE = (2048 - 64) * 1024  # the length of FLASH in boards/pico/image.ld
_SETTINGS_SIZE = 64 * 1024
_EEPROM_SIZE = 8192
_WITHOUT_DRIVER_ENABLE = ("pico-relay-b",)  # presets


def _flash_of(segments: list[image.Segment]) -> bytes:
    """Returns the content of the flash from its first byte to the end of the last segment in the flash."""
    content = bytearray()
    for segment in segments:
        begin = segment.stored_at - _FLASH
        if 0 <= begin < _IMAGE_SIZE:
            content += b"\xff" * (begin - len(content))
            content[begin : begin + len(segment.content)] = segment.content
    return bytes(content)


def _has_driver_enable(flash: bytes) -> bool:
    try:
        return info_of(flash)["board"] not in _WITHOUT_DRIVER_ENABLE
    except NotAnImage:
        return True  # the emulator says what is wrong


def main(words: list[str]) -> int:
    """Runs the program and returns its exit status. Raises SystemExit with status 2 if an argument is wrong, and with
    status 0 after `--help`."""
    parser = program.parser_for("rp2040js", f"{_BOARD.preset}, pico-eeprom, pico-w or pico-relay-b")
    parser.add_argument(
        "--flash",
        metavar="FILE",
        type=Path,
        help="keep the last 65536 bytes of the flash in this file; if the file is missing, create it with the memory "
        "of a factory-fresh module. Images store the settings in this part of the flash, unless the images are built "
        "with EX9000_MEMORY=eeprom",
    )
    parser.add_argument(
        "--eeprom",
        metavar="FILE",
        type=Path,
        help="keep the contents of the EEPROM in this file of 8192 bytes; if the file is missing, create it with the "
        "memory of a factory-fresh module. Images that are built with EX9000_MEMORY=eeprom store the settings in the "
        "EEPROM",
    )
    arguments = parser.parse_args(words)

    def memory(option: str, path: Path | None, size: int) -> int:
        return memory_file.in_file(option, path, size) if path else memory_file.in_memory(size)

    def start() -> Machine:
        content = _flash_of(image.read(arguments.image, _BOARD))
        settings = memory("--flash", arguments.flash, _SETTINGS_SIZE)
        eeprom = memory("--eeprom", arguments.eeprom, _EEPROM_SIZE)
        flash = memory_file.in_memory(len(content), content)
        return Machine(flash, settings, eeprom, arguments.init, _has_driver_enable(content))

    return program.run(arguments, "rp2040js", start)
