"""The command line of check-image."""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

from check_image import call_graph, call_sites, forbidden, sizes
from check_image.disassembly import Disassembly
from check_image.functions import Functions
from check_image.disabled_interrupts import DisabledInterrupts
from check_image.linked_graph import LinkedGraph
from check_image.stack import EXCEPTION_FRAME, Unbounded, WorstCase, worst_case
from check_image.vectors import BadVectors, Vectors
from elf_file import Elf, NotAnImage, text_of

_TOP_SYMBOLS = 20


@dataclass(frozen=True)
class Units:
    """The call graphs and the dumps that with-call-graph has put into the object files."""

    records: list[call_graph.Record]
    call_sites: dict[tuple[str, str], set[call_sites.CallSite]]


def main(arguments: list[str]) -> int:
    options = _parse(arguments)
    try:
        return _check(options)
    except OSError as error:
        problem = f"{error.filename}: {error.strerror}; check-image requires this file"
    except (NotAnImage, call_graph.NotACallGraph) as error:
        problem = str(error)
    except BadVectors as error:
        problem = f"{options.image.stem}: {error}"
    print(problem, file=sys.stderr)
    return 1


def _parse(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="check-image",
        description="Checks the contents of a firmware image. Prints its sizes and its worst-case stack.",
    )
    parser.add_argument(
        "image", type=Path, help="the linked ELF file, with a vector table in its section .vectors"
    )
    parser.add_argument(
        "units",
        type=Path,
        nargs="+",
        help=(
            "the object files, from toolchain/with-call-graph; check-image treats an object file without a call graph"
            " as assembler code"
        ),
    )
    parser.add_argument(
        "--budget",
        type=int,
        nargs=3,
        metavar=("FLASH", "RAM", "STACK"),
        help="fail if the image requires more bytes of flash, of RAM with the stack, or of stack",
    )
    parser.add_argument(
        "--level",
        action="append",
        default=[],
        metavar="HANDLER[,HANDLER]...",
        help="interrupt handlers that share a separate preemption priority; the interrupt handlers that no --level"
        " names share another priority",
    )
    parser.add_argument(
        "--verbose",
        action="store_true",
        help="also print the deepest calls, the calls through pointers, and the flash of each folder and of the"
        f" {_TOP_SYMBOLS} largest symbols",
    )
    return parser.parse_args(arguments)


def _check(options: argparse.Namespace) -> int:
    elf = Elf(options.image)
    units = _read_units(options.units)
    functions = Functions(elf)
    vectors = Vectors(elf, functions)
    disassembly = Disassembly(options.image)
    linked = LinkedGraph(elf, functions, disassembly, units.records, units.call_sites)
    disabled = DisabledInterrupts(disassembly)
    problems = forbidden.problems(elf, units.records, disassembly) + linked.problems + disabled.problems
    try:
        stack = worst_case(
            linked.graph, vectors.reset.address, vectors.levels([level.split(",") for level in options.level])
        )
    except Unbounded as unbounded:
        problems.append(str(unbounded))
        if linked.untyped:
            problems.append(
                f"{linked.untyped} calls through pointers may reach every function whose address is taken, because no"
                " dump next to the call graph contains them; compile with -fdump-tree-optimized-lineno"
            )
    else:
        problems += _report(options, elf, stack, vectors, disabled)
        if options.verbose:
            _report_stack(stack)
            _report_pointer_calls(linked)
            _report_flash(elf, options.image, linked)
    for problem in problems:
        print(f"{options.image.stem}: {problem}", file=sys.stderr)
    return 1 if problems else 0


def _read_units(paths: list[Path]) -> Units:
    units = Units([], {})
    for path in paths:
        try:
            units.records.extend(call_graph.parse(text_of(path, ".call_graph")))
        except call_graph.NotACallGraph as line:
            raise call_graph.NotACallGraph(
                f"{path}: unexpected line '{line}' in the call graph; compile with GCC 12 and with-call-graph"
            ) from line
        for place, sites in call_sites.parse(text_of(path, ".call_sites")).items():
            units.call_sites.setdefault(place, set()).update(sites)
    return units


def _report(
    options: argparse.Namespace, elf: Elf, stack: WorstCase, vectors: Vectors, disabled: DisabledInterrupts
) -> list[str]:
    """Prints the sizes, and the largest number of instructions for which interrupts are disabled.

    Returns a problem for each size that the board or the budget does not permit. Does not compare the flash with that
    of the board, because the linker fails if the flash is too small.
    """
    flash, static = sizes.flash(elf), sizes.static_ram(elf)
    ram = static + stack.size
    print(
        f"{options.image.stem}: flash {flash} bytes, RAM {ram} bytes ({static} static, {stack.size} stack at worst), "
        f"interrupts disabled for {disabled.longest} instructions"
    )
    has = vectors.stack_top - sizes.RAM.start
    problems = [f"requires {ram} bytes of RAM; the board has {has}"] if ram > has else []
    if options.budget is not None:
        for what, size, most in zip(("flash", "RAM", "stack"), (flash, ram, stack.size), options.budget):
            if size > most:
                problems.append(f"requires {size} bytes of {what}; its budget is {most} (boards/budgets)")
    return problems


def _report_stack(stack: WorstCase) -> None:
    print(f"  stack {stack.size}: main loop {stack.main.size}: {stack.main}")
    for interruption in stack.interruptions:
        print(
            f"    + {interruption.level} {interruption.size}: exception {EXCEPTION_FRAME} ->"
            f" {interruption.chain}"
        )


def _report_pointer_calls(linked: LinkedGraph) -> None:
    print("  calls through pointers, and what they reach:")
    for (caller, location), targets in sorted(linked.pointer_calls.items()):
        print(f"    {caller}, {location.rpartition('/')[2]}: {', '.join(targets)}")


def _report_flash(elf: Elf, path: Path, linked: LinkedGraph) -> None:
    print("  flash by folder:")
    root = Path(__file__).resolve().parents[2]
    for size, folder in sizes.by_folder(elf, path, linked.locations, root):
        print(f"    {size:6} {folder}")
    print("  flash by symbol:")
    for size, name in sizes.by_symbol(elf)[:_TOP_SYMBOLS]:
        print(f"    {size:6} {name}")
