"""The program boards/lm3s6965evb/run."""

from __future__ import annotations

from pathlib import Path

from emulated import image, memory_file, program
from qemu.machine import Machine

_BOARD = image.Memory(preset="lm3s6965evb", vectors=0, top_of_ram=0x20010000)
_EEPROM_SIZE = 8192


def main(words: list[str]) -> int:
    """Runs the program and returns its exit status.

    Raises SystemExit with status 2 if the arguments are wrong, and with status 0 for `--help`.
    """
    parser = program.parser_for("QEMU", _BOARD.preset)
    parser.add_argument(
        "--eeprom",
        metavar="FILE",
        type=Path,
        help="keep the contents of the EEPROM in this file of 8192 bytes; if the file is missing, create it with the "
        "memory of a factory-fresh module",
    )
    parser.add_argument("--gdb", metavar="PORT", type=int, help="let a debugger connect to 127.0.0.1:PORT")
    arguments = parser.parse_args(words)

    def start() -> Machine:
        image.read(arguments.image, _BOARD)
        if arguments.eeprom:
            eeprom = memory_file.in_file("--eeprom", arguments.eeprom, _EEPROM_SIZE)
        else:
            eeprom = memory_file.in_memory(_EEPROM_SIZE)
        return Machine(arguments.image, eeprom, arguments.init, arguments.gdb)

    return program.run(arguments, "QEMU", start)
