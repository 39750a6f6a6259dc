"""Finds the branches of the machine code, the addresses that the code loads, and the stack that it uses."""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

from check_image.functions import Function

# objdump prints a literal of a function as .word, .short or .byte; see `is_data`. It prints an object, for example a
# table, as characters. A line with characters matches only if the characters look like a mnemonic without operands.
_LINE = re.compile(r"^ *([0-9a-f]+):\t(\.?[a-z][a-z0-9.]*)(?:\t([^@;]*)|$)")
_CONDITIONS = "eq|ne|cs|hs|cc|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le"
_BRANCH = re.compile(rf"(b|bl|blx|cbz|cbnz|b({_CONDITIONS})|bl({_CONDITIONS}))(\.[nw])?")
_CALL = re.compile(rf"blx?({_CONDITIONS})?(\.[nw])?")
_TARGET = re.compile(r"(?:\w+, )?([0-9a-f]+) <")
_DIRECT_JUMP = re.compile(r"b(\.[nw])?")
_CONDITIONAL_POP = re.compile(rf"(pop|ldmia|ldr|add)({_CONDITIONS})\b")
_MAX_DEPTH = 1 << 16
_TABLE_JUMP = re.compile(r"tb[bh]")


@dataclass(frozen=True)
class Instruction:
    address: int
    mnemonic: str
    operands: str

    @property
    def branch_target(self) -> int | None:
        """Returns the target if the instruction is a branch or a call to a fixed address, else None."""
        target = _TARGET.match(self.operands) if _BRANCH.fullmatch(self.mnemonic) else None
        return int(target.group(1), 16) if target else None

    @property
    def is_call(self) -> bool:
        return _CALL.fullmatch(self.mnemonic) is not None

    @property
    def is_indirect(self) -> bool:
        """Returns whether the instruction calls or jumps to a function whose address is in a register or in memory.
        Returns False for a return and for a jump through a table."""
        if self.is_call:
            return self.branch_target is None
        if self.mnemonic.startswith("bx"):
            return self.operands != "lr"
        if self.mnemonic.startswith(("mov", "ldr")) and self.operands.startswith("pc, "):
            return re.match(r"pc, (lr$|\[sp|\[pc, r)", self.operands) is None
        return False

    @property
    def jumps_by_table(self) -> bool:
        return _TABLE_JUMP.fullmatch(self.mnemonic) is not None or (
            self.mnemonic.startswith("ldr") and self.operands.startswith("pc, [pc, r")
        )

    @property
    def is_data(self) -> bool:
        return self.mnemonic.startswith(".")

    @property
    def falls_through(self) -> bool:
        """Returns whether the next instruction in memory can be executed after this one."""
        if (
            self.is_data
            or self.jumps_by_table
            or self.mnemonic == "udf"
            or _DIRECT_JUMP.fullmatch(self.mnemonic)
        ):
            return False
        if self.mnemonic in ("bx", "pop", "pop.w", "ldmia.w", "ldr", "ldr.w", "mov"):
            returns = self.mnemonic == "bx" or re.search(r"\bpc\b", self.operands.split("[")[0])
            return not returns
        return True


class StackPointerUnknown(Exception):
    """The stack depth is known only at run time, or is more than 64 KiB, for example because a loop pushes."""


class Disassembly:
    def __init__(self, path: Path) -> None:
        done = subprocess.run(
            ["arm-none-eabi-objdump", "-d", "-z", "--no-show-raw-insn", str(path)],
            capture_output=True,
            text=True,
            check=True,
        )
        self.instructions: dict[int, Instruction] = {}
        for line in done.stdout.splitlines():
            match = _LINE.match(line)
            if match:
                address = int(match.group(1), 16)
                self.instructions[address] = Instruction(
                    address, match.group(2), (match.group(3) or "").strip()
                )

    def of(self, function: Function) -> list[Instruction]:
        return [
            self.instructions[address]
            for address in range(function.address, function.end, 2)
            if address in self.instructions
        ]

    def immediate_addresses(self) -> set[int]:
        """Returns the addresses that pairs of movw and movt load into registers."""
        lower: dict[str, int] = {}
        found = set()
        for instruction in self.instructions.values():
            match = re.fullmatch(r"(\w+), #(\d+)", instruction.operands)
            if match and instruction.mnemonic == "movw":
                lower[match.group(1)] = int(match.group(2))
            elif match and instruction.mnemonic == "movt" and match.group(1) in lower:
                found.add(int(match.group(2)) << 16 | lower[match.group(1)])
        return found


def stack_of(code: list[Instruction]) -> int:
    """Returns the maximum number of bytes that a function itself has on the stack, without the functions that it calls.

    Follows the code along its branches. Code that is not reached in this way counts as a target of the last table jump
    before it, and starts with the stack depth of this jump, or with 0 if there is no table jump. Raises
    StackPointerUnknown if an instruction moves the stack pointer by an amount that is known only at run time, or if the
    depth exceeds 64 KiB, for example because a loop pushes.
    """
    following = {a.address: b.address for a, b in zip(code, code[1:])}
    by_address = {instruction.address: instruction for instruction in code}
    depth_at: dict[int, int] = {}
    deepest = 0
    jump_depth = 0
    for start in code:
        if start.jumps_by_table:
            jump_depth = depth_at.get(start.address, 0)
        if start.address in depth_at or start.is_data:
            continue
        ways = [(start.address, 0 if start is code[0] else jump_depth)]
        while ways:
            address, depth = ways.pop()
            if address not in by_address or depth_at.get(address, -1) >= depth:
                continue
            depth_at[address] = depth
            instruction = by_address[address]
            depth += pushed_by(instruction)
            deepest = max(deepest, depth)
            if depth > _MAX_DEPTH:
                raise StackPointerUnknown(
                    "pushes more than 64 KiB, for example in a loop; push a fixed number of bytes"
                )
            target = instruction.branch_target
            if target is not None and not instruction.is_call:
                ways.append((target, depth))
            if instruction.falls_through and address in following:
                ways.append((following[address], depth))
    return deepest


def pushed_by(instruction: Instruction) -> int:
    """Returns the number of bytes by which the stack grows, negative if it shrinks. Raises StackPointerUnknown if this
    number is known only at run time."""
    growth = _growth(instruction.mnemonic.split(".")[0], instruction.operands)
    # A conditional pop is part of a conditional return. If its condition is false, it pops nothing.
    return max(growth, 0) if _CONDITIONAL_POP.match(instruction.mnemonic) else growth


def _growth(mnemonic: str, operands: str) -> int:
    registers = re.search(r"\{(.*)\}", operands)
    if mnemonic.startswith("push") or (mnemonic.startswith("stmdb") and operands.startswith("sp!")):
        return 4 * _count(registers)
    if mnemonic.startswith("pop") or (mnemonic.startswith("ldm") and operands.startswith("sp!")):
        return -4 * _count(registers)
    moved = re.search(r"\[sp, #(-?\d+)\]!|\[sp\], #(-?\d+)$", operands)
    if moved:
        return -int(moved.group(1) or moved.group(2))
    constant = re.fullmatch(r"sp, (?:sp, )?#(\d+)", operands)
    if constant and mnemonic.startswith(("sub", "add")):
        return int(constant.group(1)) * (1 if mnemonic.startswith("sub") else -1)
    if re.match(r"sp\b", operands) and mnemonic.startswith(("add", "sub", "mov", "ldr", "orr", "and", "bic")):
        raise StackPointerUnknown(
            f"moves the stack pointer with '{mnemonic} {operands}';"
            " only push, pop, add a constant or subtract a constant"
        )
    return 0


def _count(registers: re.Match[str] | None) -> int:
    """Returns the number of registers in a list. Each part of the list is a register or a range such as r4-r7."""
    assert registers is not None
    count = 0
    for part in registers.group(1).split(","):
        bounds = re.fullmatch(r"\s*r(\d+)-r(\d+)\s*", part)
        count += int(bounds.group(2)) - int(bounds.group(1)) + 1 if bounds else 1
    return count
