"""Counts the instructions during which interrupts are disabled: from each `cpsid i` to the next `cpsie i`."""

from __future__ import annotations

import re

from check_image.disassembly import Disassembly, Instruction

# If an interrupt waits longer than the transmission of a character takes, 86.8 us at 115200 baud, a byte can be lost.
# `MOST` instructions take less than 2 us on all boards.
MOST = 20

_DISABLE, _ENABLE = "cpsid", "cpsie"
_MASKS = re.compile(r"(PRIMASK|BASEPRI|BASEPRI_MAX|FAULTMASK),", re.IGNORECASE)


class _NeverEnabled(Exception):
    """A path never enables interrupts again, or its length is unknown."""


class DisabledInterrupts:
    """`longest`: number of instructions between `cpsid i` and `cpsie i` on the longest path. `problems`: messages
    about code that writes to an interrupt mask with `msr`, and about interrupts that are disabled for an unknown number
    of instructions or for more than MOST."""

    def __init__(self, disassembly: Disassembly) -> None:
        self._code = disassembly.instructions
        addresses = sorted(self._code)
        self._following = dict(zip(addresses, addresses[1:]))
        self._known: dict[int, int] = {}
        self.longest = 0
        self.problems: list[str] = []
        for address in addresses:
            instruction = self._code[address]
            if instruction.mnemonic.startswith("msr") and _MASKS.match(instruction.operands):
                self.problems.append(
                    f"{address:#x}: 'msr {instruction.operands}' changes an interrupt mask; use cpsid i and cpsie i"
                )
            if instruction.mnemonic.startswith(_DISABLE):
                self._follow(address)
        if self.longest > MOST:
            self.problems.append(
                f"interrupts are disabled for {self.longest} instructions; at most {MOST} are permitted"
            )

    def _follow(self, disabled_at: int) -> None:
        try:
            self.longest = max(self.longest, self._longest_after(disabled_at, []))
        except _NeverEnabled as reason:
            self.problems.append(
                f"{disabled_at:#x}: interrupts are disabled, and then {reason}; enable interrupts earlier with cpsie i"
            )

    def _longest_after(self, address: int, way: list[int]) -> int:
        """Returns the maximum number of instructions between the one at `address` and the next `cpsie i`."""
        if address in way:
            raise _NeverEnabled(f"there is a loop at {address:#x}")
        if address not in self._known:
            instruction = self._code[address]
            self._known[address] = max(
                self._from(following, [*way, address]) for following in self._next(instruction)
            )
        return self._known[address]

    def _from(self, address: int, way: list[int]) -> int:
        instruction = self._code.get(address)
        if instruction is None or instruction.is_data:
            raise _NeverEnabled(f"there is no code at {address:#x}")
        if instruction.mnemonic.startswith(_ENABLE):
            return 0
        return 1 + self._longest_after(address, way)

    def _next(self, instruction: Instruction) -> list[int]:
        if instruction.is_call or instruction.is_indirect or instruction.jumps_by_table:
            raise _NeverEnabled(f"{instruction.address:#x} makes a call or jump that check-image cannot follow")
        following = [] if instruction.branch_target is None else [instruction.branch_target]
        if instruction.falls_through:
            following += [self._following.get(instruction.address, -1)]
        if not following:
            raise _NeverEnabled(f"{instruction.address:#x} returns")
        return following
