"""Reads the vector table of an image (Armv7-M ARM B1.5.2 and B1.5.3) and groups the handlers by priority."""

from __future__ import annotations

import struct
from collections.abc import Sequence

from check_image.functions import Function, Functions
from check_image.stack import Level
from elf_file import Elf

_RESET = 1
_NMI = 2
_HARD_FAULT = 3
_CONFIGURABLE_FAULTS = range(4, 7)  # MemManage, BusFault, UsageFault


class BadVectors(Exception):
    """The table is missing or too short, contains a value that is neither 0 nor the address of a function, or has no
    reset handler. Or --level names a function that is not an interrupt handler or that an earlier --level names."""


class Vectors:
    def __init__(self, elf: Elf, functions: Functions) -> None:
        section = elf.named(".vectors")
        if section is None or len(section.data) < 8:
            raise BadVectors("the section .vectors is missing or too short; link with the image.ld of a board")
        words = struct.unpack(f"<{len(section.data) // 4}I", section.data[: len(section.data) // 4 * 4])
        self.stack_top = words[0]
        self.handlers: dict[int, Function] = {}  # by exception number, including Reset
        for number, word in enumerate(words[1:], start=1):
            if word == 0:
                continue
            function = functions.at(word & ~1)
            if function is None or word & 1 == 0:
                raise BadVectors(f"vector {number}: {word:#010x} is not the address of a function; name a handler")
            self.handlers[number] = function
        if _RESET not in self.handlers:
            raise BadVectors("the vector table has no reset handler; name the function that starts the image")

    @property
    def reset(self) -> Function:
        return self.handlers[_RESET]

    def levels(self, named: Sequence[Sequence[str]]) -> list[Level]:
        """Returns all handlers except the reset handler, in levels. Handlers of one level cannot interrupt each other.
        Handlers of different levels can be active at the same time. A level can be empty.

        `named`: for each level with a separate priority, the names of its handlers. The other interrupts form one
        level. The configurable faults form one level, because a fault in a fault handler becomes a HardFault. HardFault
        and NMI form one level each, because NMI can interrupt the HardFault handler.

        Raises BadVectors if a name in `named` is not the name of an interrupt handler, or if an earlier level already
        has this handler.
        """
        own: list[Level] = []
        left = {
            number: handler for number, handler in self.handlers.items() if number > _CONFIGURABLE_FAULTS[-1]
        }
        for names in named:
            chosen = {number for number, handler in left.items() if set(handler.names) & set(names)}
            missing = set(names) - {name for number in chosen for name in left[number].names}
            if missing:
                names_of_missing = ", ".join(sorted(missing))
                raise BadVectors(
                    f"--level: no remaining interrupt has the handler {names_of_missing}; name the handler of an"
                    " interrupt, and only in one --level"
                )
            own.append(Level("+".join(names), [left.pop(number).address for number in sorted(chosen)]))
        return [
            Level("interrupts", _addresses(left)),
            *own,
            Level(
                "faults",
                _addresses({n: self.handlers[n] for n in _CONFIGURABLE_FAULTS if n in self.handlers}),
            ),
            Level("HardFault", _addresses({n: h for n, h in self.handlers.items() if n == _HARD_FAULT})),
            Level("NMI", _addresses({n: h for n, h in self.handlers.items() if n == _NMI})),
        ]


def _addresses(handlers: dict[int, Function]) -> list[int]:
    return sorted({handler.address for handler in handlers.values()})
