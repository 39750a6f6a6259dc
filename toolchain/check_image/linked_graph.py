"""Builds the call graph of the linked image from the compiler's records, and compares them with the machine code."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from check_image.call_graph import Record, Title
from check_image.call_sites import CallSite, VirtualCall
from check_image.disassembly import Disassembly, Instruction, StackPointerUnknown, stack_of
from check_image.functions import Function, Functions
from check_image.stack import Graph, Node
from elf_file import Elf


@dataclass(frozen=True)
class Foreign:
    """A function for which the compiler wrote no record. `reason` states why its stack use has an upper bound."""

    frame: int  # the upper bound in bytes
    reason: str


# check-image compares each frame with the number of bytes that the instructions push, and takes the calls from the
# instructions.
FOREIGN = {
    "memcpy": Foreign(8, "from newlib or newlib-nano: it contains loops and no calls"),
    "memmove": Foreign(16, "from newlib or newlib-nano: it contains loops and no calls"),
    "memset": Foreign(16, "from newlib or newlib-nano: it contains loops and no calls"),
    "memcmp": Foreign(16, "from newlib or newlib-nano: it contains loops and no calls"),
    "__aeabi_uidiv": Foreign(8, "libgcc's division for a processor without a division instruction"),
    "__aeabi_uidivmod": Foreign(0, "from libgcc: it continues in __aeabi_uidiv"),
    "__aeabi_idiv0": Foreign(0, "from libgcc: it only returns"),
}

_VENEER = re.compile(r"__(.*)_veneer")


class LinkedGraph:
    """In `graph`, the address identifies a function: aliases are one function, and functions with the same name
    in different files are separate.

    `problems` lists the differences between the compiler's records and the machine code, even in functions that no call
    reaches.
    """

    def __init__(
        self,
        elf: Elf,
        functions: Functions,
        disassembly: Disassembly,
        records: Iterable[Record],
        call_sites: Mapping[tuple[str, str], set[CallSite]],
    ) -> None:
        self._elf = elf
        self._functions = functions
        self._disassembly = disassembly
        self._call_sites = call_sites
        self._address_taken = self._find_taken_addresses()
        self._tables = self._find_virtual_tables()
        self.problems: list[str] = []
        self.locations: dict[int, str] = {}  # locations of the recorded functions, by address
        self.graph: Graph = {}
        self._calls_indirectly: set[int] = set()
        self.pointer_calls: dict[tuple[str, str], list[str]] = {}  # targets of each call, by caller and location
        self.untyped = 0  # pointer calls that no dump contains; they can reach all functions whose address is taken
        for record in records:
            function = self._find(record.title)
            if function is not None:  # otherwise it was inlined everywhere, or the linker has removed it
                self._add(function, record)
        for function in functions:
            if function.address in self.locations:
                self._compare_with_code(function)
            else:
                self._add_unrecorded(function)

    def _find(self, title: Title) -> Function | None:
        # GCC writes the file before the name of an inline function too, but the linker keeps one global copy for all
        # units. If the file has no local function with this name, _find therefore searches the global functions.
        in_file = self._functions.local_named(title.name, title.file) if title.file else None
        return in_file or self._functions.global_named(title.name)

    def _add(self, function: Function, record: Record) -> None:
        problem = (
            ""
            if record.is_bounded
            else "uses an amount of stack that is known only at run time; use objects of a fixed size"
        )
        calls = set()
        for title in record.calls:
            target = self._find(title)
            if target is None and title.name.startswith("__aeabi_"):
                continue  # the compiler removed this call of its run-time library after it had written the record
            if target is None:
                problem = f"calls {title.name}, which the image does not have; link it"
            else:
                calls.add(target.address)
        for location in record.indirect_calls:
            targets = self._indirect_targets(record.title.name, location)
            if not targets:
                problem = f"calls through a pointer at {location}, but no function matches; remove the call"
            calls |= targets
            self.pointer_calls[str(function), location] = [
                str(self._functions.at(t)) for t in sorted(targets)
            ]
        node = Node(str(function), record.frame, frozenset(calls), problem)
        before = self.graph.get(function.address)  # not None for an inline function that several units contain
        self.graph[function.address] = _worse_of(before, node) if before else node
        self.locations[function.address] = record.location
        if record.indirect_calls:
            self._calls_indirectly.add(function.address)

    # --- calls through pointers ---

    def _indirect_targets(self, caller: str, location: str) -> set[int]:
        sites = self._call_sites.get((caller, location))
        if not sites:
            self.untyped += 1
            return {function.address for function in self._address_taken}
        targets: set[int] = set()
        for site in sites:
            candidates = self._address_taken
            if isinstance(site, VirtualCall):
                candidates = [table[site.slot] for table in self._tables if site.slot < len(table)]
            targets |= {function.address for function in candidates if site.can_reach(function)}
        return targets

    def _find_taken_addresses(self) -> list[Function]:
        """Returns the functions whose address is in a table other than the vector table, in the initial value of a
        variable, in a literal pool, or in a pair of movw and movt."""
        taken = set(self._disassembly.immediate_addresses())
        for section in self._elf.sections:
            if section.loaded and section.name != ".vectors":
                start = -section.address % 4
                end = start + (len(section.data) - start) // 4 * 4
                taken.update(memoryview(section.data[start:end]).cast("I"))
        return [function for function in self._functions if function.address | 1 in taken]

    def _find_virtual_tables(self) -> list[list[Function]]:
        """Returns the functions of each virtual table, by slot (Itanium C++ ABI 2.5.2).

        A table begins with two words that are not functions. The table of a class with several polymorphic bases
        consists of several such tables.
        """
        tables = []
        for symbol in self._elf.symbols:
            if not symbol.name.startswith("_ZTV"):
                continue
            table: list[Function] = []
            for address in range(symbol.address, symbol.address + symbol.size, 4):
                word = self._elf.word_at(address) or 0
                function = self._functions.at(word & ~1) if word & 1 else None
                if function is not None:
                    table.append(function)
                elif table:
                    tables.append(table)
                    table = []
            if table:
                tables.append(table)
        return tables

    # --- the machine code ---

    def _compare_with_code(self, function: Function) -> None:
        node = self.graph[function.address]
        code = self._disassembly.of(function)
        for target in self._targets_in_code(function, code):
            if target.address not in node.calls:
                self.problems.append(
                    f"{node.name}: branches to {target}, but the compiler recorded no such call; call it from C++"
                )
        if any(i.is_indirect for i in code) and function.address not in self._calls_indirectly:
            self.problems.append(
                f"{node.name}: branches through a register, but the compiler recorded no indirect call;"
                " call through a pointer from C++"
            )
        try:
            pushed = stack_of(code)
        except StackPointerUnknown as unknown:
            self.problems.append(f"{node.name}: {unknown}")
            return
        if pushed > node.frame:
            self.problems.append(
                f"{node.name}: uses {pushed} bytes of stack, but the compiler recorded only {node.frame};"
                " do not push in assembler code"
            )

    def _targets_in_code(self, function: Function, code: list[Instruction]) -> list[Function]:
        """Returns the functions that the code calls or jumps to directly, in the order of the code.

        The result contains each function only once. It does not contain `function`.
        """
        targets: dict[int, Function] = {}
        for instruction in code:
            target = instruction.branch_target
            if target is None or function.address <= target < function.end:
                continue
            there = self._functions.around(target)
            if there is not None:
                callee = self._behind_veneer(there)
                targets[callee.address] = callee
        return list(targets.values())

    def _behind_veneer(self, function: Function) -> Function:
        """If `function` is a veneer, and exactly one function has the name of its target, returns this target.
        Otherwise returns `function`.

        The linker inserts a veneer if a function is beyond the range of a branch.
        """
        match = _VENEER.fullmatch(function.name)
        there = self._functions.named(match.group(1)) if match else []
        return there[0] if len(there) == 1 else function

    def _add_unrecorded(self, function: Function) -> None:
        code = self._disassembly.of(function)
        calls = frozenset(t.address for t in self._targets_in_code(function, code))
        known = next((FOREIGN[name] for name in function.names if name in FOREIGN), None)
        frame, problem = 0, "the compiler recorded no stack; add the function to FOREIGN in linked_graph.py"
        if known is not None:
            frame, problem = known.frame, _compare_with_table(known, code)
        self.graph[function.address] = Node(str(function), frame, calls, problem)


def _worse_of(a: Node, b: Node) -> Node:
    """Returns a node that is an upper bound for both nodes, because the image can contain the code of either."""
    return Node(a.name, max(a.frame, b.frame), a.calls | b.calls, a.problem or b.problem)


def _compare_with_table(known: Foreign, code: list[Instruction]) -> str:
    try:
        pushed = stack_of(code)
    except StackPointerUnknown as unknown:
        return str(unknown)
    if pushed > known.frame:
        return f"uses {pushed} bytes of stack; FOREIGN in linked_graph.py permits {known.frame}"
    if any(instruction.is_indirect for instruction in code):
        return "branches through a register; FOREIGN in linked_graph.py requires direct branches"
    return ""
