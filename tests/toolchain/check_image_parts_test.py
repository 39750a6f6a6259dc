"""Tests parts of check-image separately: what the small images of the other tests do not contain."""

from __future__ import annotations

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "toolchain"))

from check_image import call_graph, call_sites, main  # noqa: E402
from check_image.disassembly import Instruction, StackPointerUnknown, stack_of  # noqa: E402
from check_image.functions import Function, demangle, without_parameters  # noqa: E402
from check_image.stack import Graph, Level, Node, worst_case  # noqa: E402


class WorstCase(unittest.TestCase):
    GRAPH: Graph = {
        0: Node("reset", 8, frozenset({1, 2})),
        1: Node("turn", 100, frozenset({3})),
        2: Node("start", 50, frozenset({3})),
        3: Node("leaf", 4, frozenset()),
        10: Node("uart", 16, frozenset({3})),
        11: Node("timer", 24, frozenset()),
        12: Node("tick", 12, frozenset({3})),
    }

    def test_only_the_deepest_handler_of_a_level_counts(self) -> None:
        # reset, turn and leaf use 8 + 100 + 4 bytes, the exception uses 36, and the deepest handler, timer, uses 24.
        self.assertEqual(worst_case(self.GRAPH, 0, [Level("interrupts", [10, 11, 12])]).size, 112 + 36 + 24)

    def test_levels_add_up(self) -> None:
        levels = [Level("interrupts", [10, 11]), Level("tick", [12]), Level("faults", [])]
        self.assertEqual(worst_case(self.GRAPH, 0, levels).size, 112 + (36 + 24) + (36 + 16))


class UnsuitableFiles(unittest.TestCase):
    def test_a_missing_file_and_a_file_that_is_not_an_image_are_reported(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            image, missing = Path(folder, "image.elf"), Path(folder, "missing.elf")
            image.write_text("text", encoding="utf-8")
            self.assertEqual(
                self.printed(missing), f"{missing}: No such file or directory; check-image requires this file\n"
            )
            self.assertEqual(
                self.printed(image),
                f"{image}: the file is not a 32-bit little-endian ELF file for Arm; name the linked image\n",
            )

    def test_an_unexpected_line_of_a_call_graph_is_rejected(self) -> None:
        for line in ("node: { }", 'edge: { sourcename: "unknown" targetname: "other" }', "region: {"):
            with self.assertRaises(call_graph.NotACallGraph):
                call_graph.parse(line)

    @staticmethod
    def printed(image: Path) -> str:
        with contextlib.redirect_stderr(io.StringIO()) as errors:
            assert main.main([str(image), "unit.o"]) == 1
        return errors.getvalue()


class CallsThroughPointers(unittest.TestCase):
    DUMP = """
;; Function answer (_Z6answerRK5State, funcdef_no=3, decl_uid=1, cgraph_uid=2, symbol_order=1)

Refusal answer (const struct State & state, struct Bytes args)
{
  Refusal (*<T44ec>) (const struct State &, struct Bytes, uint16_t, Kind) _5;
  void Thing::<T2b8> (struct Thing *) * SR.13;
  Refusal _6;

  <bb 2> [local count: 1073741824]:
  [dcon.cpp:9:71] _6 = _5 (state_1(D), [dcon.cpp:9:70] args, 3, kind_2(D));
  [dcon.cpp:10:5] SR.13_12 (_3); [tail call]
  [dcon.cpp:11:5] direct (_3, 4);
  [dcon.cpp:12:7] _9 = OBJ_TYPE_REF(_4;(const struct Memory)_2->3B) (_2, f_1 (D));
  [dcon.cpp:13:7] alias_7(D) (_3, _4);
}
"""

    def reaches(self, line: int, column: int, readable: str) -> bool:
        """Returns whether all calls at this location can reach a function with this demangled name."""
        sites = call_sites.parse(self.DUMP)["_Z6answerRK5State", f"dcon.cpp:{line}:{column}"]
        return all(site.can_reach(Function("", readable, 0, 0, ())) for site in sites)

    def test_the_parameters_decide_which_functions_a_call_can_reach(self) -> None:
        for readable, expected in {
            "ex::read(ex::State const&, ex::Bytes, unsigned short, ex::Kind)": True,
            "ex::read(ex::State const&, ex::Bytes, unsigned short, char)": True,  # Kind can be an alias of char
            "read": True,  # a C function: its name does not contain its parameters
            "ex::read(ex::State const&, ex::Bytes, unsigned int, ex::Kind)": False,
            "ex::read(ex::State*, ex::Bytes, unsigned short, ex::Kind)": False,
            "ex::read(ex::Other const&, ex::Bytes, unsigned short, ex::Kind)": False,
            "ex::read(ex::State const&, ex::Bytes, unsigned short)": False,
            "run()::{lambda(ex::State const&, ex::Bytes)#1}::_FUN(ex::State const&, ex::Bytes)": False,
        }.items():
            with self.subTest(readable):
                self.assertEqual(self.reaches(9, 71, readable), expected)

    def test_the_object_is_the_first_parameter_of_a_member_function(self) -> None:
        self.assertTrue(self.reaches(10, 5, "Thing::turn()"))
        self.assertFalse(self.reaches(10, 5, "Thing::turn(int)"))

    def test_a_virtual_call_has_a_slot_and_reaches_functions_with_its_constness_and_parameter_count(self) -> None:
        (site,) = call_sites.parse(self.DUMP)["_Z6answerRK5State", "dcon.cpp:12:7"]
        self.assertEqual(site, call_sites.VirtualCall(3, True, 1))
        self.assertTrue(self.reaches(12, 7, "Eeprom::busy(int) const"))
        self.assertFalse(self.reaches(12, 7, "Eeprom::busy(int)"))
        self.assertFalse(self.reaches(12, 7, "Eeprom::busy() const"))

    def test_only_the_parameter_count_limits_the_targets_of_a_call_through_a_named_function_type(self) -> None:
        self.assertTrue(self.reaches(13, 7, "ex::at(int, ex::Time)"))
        self.assertFalse(self.reaches(13, 7, "ex::at(int, ex::Time, int)"))

    def test_direct_calls_are_not_listed(self) -> None:
        self.assertNotIn(("_Z6answerRK5State", "dcon.cpp:11:5"), call_sites.parse(self.DUMP))


class MachineCode(unittest.TestCase):
    def stack(self, text: str) -> int:
        """Returns the number of bytes that the code in `text` uses on the stack. Each line is an instruction of 2
        bytes: the mnemonic, a space and the operands. In the operands, `@N` is the address of line N, counted from
        0."""
        code = []
        for number, line in enumerate(text.strip().splitlines()):
            mnemonic, _, operands = line.strip().partition(" ")
            at = operands.find("@")
            if at >= 0:
                operands = f"{operands[:at]}{2 * int(operands[at + 1:]):x} <f>"
            code.append(Instruction(2 * number, mnemonic, operands))
        return stack_of(code)

    def test_pushes_and_frames_add_up(self) -> None:
        self.assertEqual(
            self.stack("push {r4, r5, r6, lr}\nsub sp, #24\nadd sp, #24\npop {r4, r5, r6, pc}"), 40
        )
        self.assertEqual(
            self.stack("stmdb sp!, {r4-r11, lr}\nsub.w sp, sp, #512\nstrd r0, r1, [sp, #-8]!\nbx lr"), 556
        )
        self.assertEqual(self.stack("str.w lr, [sp, #-4]!\nldr.w pc, [sp], #4"), 4)

    def test_alternative_branches_do_not_add_up(self) -> None:
        text = "cbz r0, @4\npush {r4, lr}\nbl @0\npop {r4, pc}\npush {r3, r4, r5, lr}\npop {r3, r4, r5, pc}"
        self.assertEqual(self.stack(text), 16)

    def test_a_conditional_return_does_not_end_the_frame(self) -> None:
        self.assertEqual(
            self.stack("push {r4, lr}\nit ne\npopne {r4, pc}\nsub sp, #8\nadd sp, #8\npop {r4, pc}"), 16
        )

    def test_the_targets_of_a_table_jump_begin_at_its_stack_depth(self) -> None:
        text = "push {r4, lr}\ntbb [pc, r0]\n.short 0x0201\nsub sp, #8\nadd sp, #8\npop {r4, pc}"
        self.assertEqual(self.stack(text), 16)

    def test_a_conditional_branch_is_not_a_call(self) -> None:
        self.assertEqual(self.stack("bls.n @2\nbx lr\npush {r4, lr}\npop {r4, pc}"), 8)

    def test_the_stack_is_unknown_if_the_stack_pointer_is_computed_or_a_loop_pushes(self) -> None:
        for text in ("sub sp, r0", "mov sp, r7", "add.w sp, sp, r3", "push {r0}\nb.n @0"):
            with self.subTest(text), self.assertRaises(StackPointerUnknown):
                self.stack(text)

    def test_only_calls_and_jumps_through_pointers_are_indirect(self) -> None:
        for mnemonic, operands, expected in (
            ("blx", "r3", True),
            ("bx", "r3", True),
            ("ldr.w", "pc, [r0, #4]", True),
            ("mov", "pc, r2", True),
            ("bx", "lr", False),
            ("mov", "pc, lr", False),
            ("ldr.w", "pc, [sp], #4", False),
            ("bl", "8000 <f>", False),
            ("ldr.w", "pc, [pc, r2, lsl #2]", False),  # a jump table of the function
        ):
            with self.subTest(f"{mnemonic} {operands}"):
                self.assertEqual(Instruction(0, mnemonic, operands).is_indirect, expected)


class Names(unittest.TestCase):
    def test_names_have_no_parameters_return_types_or_anonymous_namespaces(self) -> None:
        for mangled, expected in {
            "_ZN6ex90006Module5beginEtNS_4TimeEPFNS_10LineTimingEmE": "ex9000::Module::begin",
            "_ZNK12_GLOBAL__N_11AclEi.isra.0": "A::operator()",
            "_ZN1a1fILj3EEEvv": "a::f<3u>",
            "_ZZ3lamiENKUliE_clEi": "lam::{lambda#1}::operator()",
            "reset": "reset",
        }.items():
            self.assertEqual(without_parameters(demangle([mangled])[mangled]), expected)


if __name__ == "__main__":
    unittest.main()
