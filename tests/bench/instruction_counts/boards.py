"""The boards for whose images tests/bench/instructions counts instructions."""

import collections
import pathlib

from instruction_counts.capacity import capacity
from instruction_counts.emulator import Emulator
from instruction_counts.execution import LM3S6965, RP2040
from instruction_counts.pico_emulator import PicoEmulator

FOLDER = pathlib.Path(__file__).resolve().parent.parent

# `init`: the pin of INIT*. `groups`: the pins of the inputs; one interrupt serves all pins of a group. `start_up`: the
# emulated time from power-up until the module has nothing to do, in seconds. `record`: the file with the recorded
# counts. `capacity`: a function that returns a text about the pulses that a TM4C123 can count; None if the board has no
# such function.
Board = collections.namedtuple("Board", "emulator interrupts init groups start_up record capacity")

BOARDS = {
    "lm3s6965evb": Board(
        emulator=Emulator,
        interrupts=LM3S6965,
        init="A7",
        groups=[["B0", "B1", "B4", "B5", "B6"], ["C4", "C5", "C6"]],
        start_up=0.1,
        record=FOLDER / "recorded_instructions",
        capacity=capacity,
    ),
    # On its first start, the module erases the flash sectors for the settings, so the start takes longer.
    "pico": Board(
        emulator=PicoEmulator,
        interrupts=RP2040,
        init="GP3",
        groups=[[f"GP{number}" for number in range(14, 22)]],
        start_up=1.0,
        record=FOLDER / "recorded_instructions_pico",
        capacity=None,
    ),
}
