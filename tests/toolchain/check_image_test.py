"""Tests check-image on images that it accepts, and on an image that exceeds its budget."""

from __future__ import annotations

import re
import unittest

from sample import Verdict, check, holding

EXCEPTION = 36


class Accepts(unittest.TestCase):
    def stack(self, verdict: Verdict) -> int:
        """Returns the worst-case stack without the exception frames of HardFault and NMI. The handlers of these
        two exceptions use no stack."""
        self.assertTrue(verdict.accepted, verdict.problems)
        match = re.search(r"(\d+) stack at worst", verdict.figures)
        assert match
        return int(match.group(1)) - 2 * EXCEPTION

    def test_an_empty_main_loop_and_an_empty_interrupt_handler_require_one_exception_frame(self) -> None:
        self.assertEqual(self.stack(check('extern "C" void reset() { for (;;) {} }')), EXCEPTION)

    def test_frames_add_up_along_the_deepest_calls(self) -> None:
        verdict = check(
            """
            FAR void shallow() { room<16>(); }
            FAR void deepest() { room<100>(); }
            FAR void deep() { room<24>(); deepest(); }
            extern "C" void reset() { for (;;) { shallow(); deep(); } }
            """,
            options="--verbose",
        )
        # `reset` saves 8 bytes of registers. The arrays of `deep` and `deepest` have 24 and 100 bytes. The
        # compiler rounds the frame of `deepest` up to 104 bytes, a multiple of eight.
        self.assertIn("main loop 136: reset 8 -> deep 24 -> deepest 104", verdict.figures)
        self.assertEqual(self.stack(verdict), 136 + EXCEPTION)

    def test_an_interrupt_adds_an_exception_frame_and_the_frame_of_its_handler(self) -> None:
        source = """
            extern "C" void reset() { for (;;) {} }
            extern "C" void interrupt() { room<40>(); }
            """
        self.assertEqual(self.stack(check(source)), EXCEPTION + 40)
        # With --level, the handler is alone on a separate level, and there is no handler on the shared level.
        self.assertEqual(self.stack(check(source, options="--level interrupt")), EXCEPTION + 40)

    def test_a_processor_without_a_divide_instruction_calls_the_function_of_libgcc(self) -> None:
        verdict = check(
            """
            extern volatile unsigned a, b;
            volatile unsigned a = 1, b = 1;
            FAR void divide() { room<16>(); a = a / b + a % b; }
            extern "C" void reset() { for (;;) divide(); }
            """,
            options="--verbose",
            compile_options="-mcpu=cortex-m0plus",
            link_options="-mcpu=cortex-m0plus -lgcc",
        )
        self.assertRegex(verdict.figures, r"reset \d+ -> divide \d+ -> __(aeabi_uidiv|udivsi3|aeabi_uidivmod)")
        self.assertTrue(verdict.accepted, verdict.problems)

    def test_pointers_reach_only_functions_of_their_type(self) -> None:
        verdict = check(
            """
            struct One { int value; };
            struct Other { int value; };
            FAR int of_one(const One& one) { room<40>(); return one.value; }
            FAR int of_one_too(const One& one) { room<48>(); return one.value; }
            FAR int of_other(const Other& other) { room<400>(); return other.value; }
            FAR int of_number(unsigned number) { room<800>(); return int(number); }
            extern int (*const volatile ones[])(const One&);
            extern int (*const volatile others[])(const Other&);
            extern int (*const volatile numbers[])(unsigned);
            int (*const volatile ones[])(const One&) = {of_one, of_one_too};
            int (*const volatile others[])(const Other&) = {of_other};
            int (*const volatile numbers[])(unsigned) = {of_number};
            FAR int call_other(const Other& other) { return others[0](other) + numbers[0](1) ; }
            extern "C" void reset() { One one{1}; for (volatile int i = 0;; i = 1 - i) one.value = ones[i](one); }
            extern "C" void interrupt() { Other other{1}; call_other(other); }
            """,
            options="--verbose",
        )
        self.assertRegex(verdict.figures, r"main loop \d+: reset \d+ -> of_one_too 48\n")
        self.assertRegex(verdict.figures, r"-> call_other \d+ -> of_number 80\d\n")
        self.assertRegex(verdict.figures, r"reset, .*: of_one, of_one_too\n")

    def test_virtual_calls_reach_the_functions_of_their_slot(self) -> None:
        verdict = check(
            """
            struct Base {
              virtual void first() = 0;
              virtual int second() const = 0;
              virtual int third() = 0; };
            struct Flat : Base {
              void first() override { room<400>(); }
              int second() const override { room<40>(); return 1; }
              int third() override { room<800>(); return 2; } };
            struct Deep : Base {
              void first() override { room<400>(); }
              int second() const override { room<80>(); return 3; }
              int third() override { room<800>(); return 4; } };
            constexpr Flat flat; constexpr Deep deep;
            const Base* volatile which;
            FAR int ask(const Base& base) { return base.second() + 1; }
            extern "C" void reset() { for (;;) { which = &flat; which = &deep; ask(*which); } }
            """,
            options="--verbose",
        )
        self.assertTrue(verdict.accepted, verdict.problems)
        self.assertRegex(verdict.figures, r"-> ask \d+ -> Deep::second 80\n")
        self.assertRegex(verdict.figures, r"ask, .*: Flat::second, Deep::second\n")

    def test_static_functions_with_the_same_name_in_two_files_are_different(self) -> None:
        verdict = check(
            """
            void other();
            static FAR void same() { room<40>(); }
            extern "C" void reset() { for (;;) { same(); other(); } }
            """,
            """
            static FAR void same() { room<80>(); asm volatile(""); }
            FAR void other() { same(); }
            """,
            options="--verbose",
        )
        self.assertRegex(verdict.figures, r"main loop \d+: reset 8 -> other 0 -> same 80\n")

    def test_a_handler_that_is_an_alias_of_a_function_uses_the_stack_of_this_function(self) -> None:
        verdict = check(
            """
            extern "C" void reset() { for (;;) {} }
            extern "C" FAR void real() { room<40>(); }
            extern "C" void interrupt() __attribute__((alias("real")));
            """
        )
        self.assertEqual(self.stack(verdict), EXCEPTION + 40)

    def test_code_in_ram_is_reached_through_the_linkers_veneers(self) -> None:
        verdict = check(
            """
            FAR __attribute__((section(".ram_code"))) void program() { room<40>(); }
            extern "C" void reset() { for (;;) { program(); } }
            """,
            options="--verbose",
        )
        self.assertRegex(verdict.figures, r"main loop \d+: reset 8 -> program 40\n")
        self.assertTrue(verdict.accepted, verdict.problems)

    def test_the_memory_functions_of_newlib_stay_within_their_stack_limits(self) -> None:
        source = """
            #include <string.h>
            unsigned char a[999], b[999];
            volatile unsigned size;
            volatile int sum;
            extern "C" void reset() {
              for (;;) {
                memcpy(a, b, size); memmove(a + sum, a, size); memset(a, 1, size); sum = memcmp(a, b, size); } }
            """
        for library in ("-lc", "-lc_nano"):
            verdict = check(source, link_options=library)
            self.assertTrue(verdict.accepted, verdict.problems)

    def test_a_pointer_to_a_member_function_reaches_only_functions_of_its_type(self) -> None:
        verdict = check(
            """
            struct Thing { int value; FAR void plain() { room<40>(); } FAR void other(int) { room<400>(); } };
            void (Thing::* volatile which)() = &Thing::plain;
            void (Thing::* volatile unused)(int) = &Thing::other;
            extern "C" void reset() { Thing thing{1}; for (;;) { (thing.*which)(); unused = nullptr; } }
            """,
            options="--verbose",
        )
        self.assertRegex(verdict.figures, r"main loop \d+: reset \d+ -> Thing::plain 40\n")

    def test_flash_and_ram_of_an_image_are_printed(self) -> None:
        verdict = check(
            """
            volatile unsigned char with_value[100] = {1};
            volatile unsigned char without[200];
            [[gnu::section(".noinit")]] volatile unsigned char kept[300];
            extern "C" void reset() { for (;;) { with_value[0] = without[0] = kept[0]; } }
            """
        )
        self.assertIn("(600 static,", verdict.figures)
        self.assertRegex(verdict.figures, r"^image: flash 196 bytes, RAM 708 bytes")

    def test_instructions_with_disabled_interrupts_are_counted_on_the_longest_path(self) -> None:
        verdict = check(
            """
            extern "C" void reset() {
              for (;;) asm volatile("cpsid i\\ncbz r0, 1f\\nnop\\nnop\\n1: wfi\\ncpsie i" ::: "memory");
            }
            """
        )
        self.assertTrue(verdict.accepted, verdict.problems)
        self.assertIn("interrupts disabled for 4 instructions\n", verdict.figures)
        self.assertIn(
            "interrupts disabled for 20 instructions\n", check(holding("nop\\n" * 20)).figures
        )

    def test_data_that_looks_like_an_instruction_is_ignored(self) -> None:
        for text in ("v-", "vmu", "vmul.f3"):
            verdict = check(
                f"""
                extern "C" const volatile char text[];
                asm(".section .text.text,\\"ax\\"\\n.global text\\n.type text, %object\\n.size text, 8\\n"
                    "text: .ascii \\"{text:8}\\"");
                extern "C" void reset() {{ for (;;) text[0]; }}
                """
            )
            self.assertTrue(verdict.accepted, verdict.problems)

    def test_an_image_is_accepted_up_to_its_budget(self) -> None:
        source = 'volatile char a[100]; extern "C" void reset() { for (;;) a[0] = 1; }'
        figures = check(source).figures
        flash, ram, stack = (int(n) for n in re.search(r"flash (\d+) .*RAM (\d+) .*, (\d+) stack", figures).groups())
        self.assertEqual((ram, stack), (208, 108))
        self.assertTrue(check(source, options=f"--budget {flash} {ram} {stack}").accepted)
        for budget in ((flash - 1, ram, stack), (flash, ram - 1, stack), (flash, ram, stack - 1)):
            verdict = check(source, options="--budget " + " ".join(map(str, budget)))
            self.assertFalse(verdict.accepted)
            self.assertRegex(verdict.problems, r"^image: requires \d+ bytes of \w+; its budget is \d+ .*\n?$")


if __name__ == "__main__":
    unittest.main()
