"""Tests the reason that check-image prints when it rejects an image."""

from __future__ import annotations

import unittest

from sample import check, holding

# The reasons, as regular expressions, each with a source that is refused for it.
REFUSED = {
    # --- stack ---
    "recursion: ping -> pong -> ping; use a loop$": """
    FAR int pong(int n);
    FAR int ping(int n) { return n ? pong(n - 1) + 1 : 0; }
    FAR int pong(int n) { return n ? ping(n - 1) + 2 : 0; }
    extern "C" void reset() { for (volatile int i = 0;; ) i = ping(i); }
    """,
    "recursion: walk -> walk; use a loop$": """
    struct Tree { int value; };
    FAR int walk(const Tree& tree);
    extern int (*const volatile visit)(const Tree&);
    int (*const volatile visit)(const Tree&) = walk;
    FAR int walk(const Tree& tree) { return visit(tree) + 1; }
    extern "C" void reset() { Tree tree{1}; for (;;) tree.value = walk(tree); }
    """,
    "recursion: interrupt -> interrupt; use a loop$": """
    volatile int n;
    extern "C" void reset() { for (;;) {} }
    extern "C" FAR void interrupt() { if (n) { interrupt(); n = n - 1; interrupt(); n = n + 1; } }
    """,
    "foreign, reached by reset -> foreign: the compiler recorded no stack; add the function to FOREIGN": """
    extern "C" void foreign();
    asm(".section .text.foreign\\n.thumb_func\\n.global foreign\\n.type foreign, %function\\n"
        "foreign: bx lr\\n.size foreign, .-foreign\\n.text");
    extern "C" void reset() { for (;;) foreign(); }
    """,
    "memset, reached by reset -> memset: uses 64 bytes of stack; FOREIGN in linked_graph.py permits 16": """
    extern "C" void* memset(void*, int, size_t);
    asm(".section .text.memset\\n.thumb_func\\n.global memset\\n.type memset, %function\\n"
        "memset: sub sp, #64\\nadd sp, #64\\nbx lr\\n.size memset, .-memset\\n.text");
    volatile unsigned size;
    extern "C" void reset() { for (;;) memset(&stack_top, 0, size); }
    """,
    "reset: branches to hidden, but the compiler recorded no such call; call it from C": """
    extern "C" __attribute__((used)) FAR void hidden() { room<40>(); }
    extern "C" void reset() { for (;;) asm volatile("bl hidden" ::: "lr", "memory"); }
    """,
    "interrupt: branches to hidden, but the compiler recorded no such call; call it from C": """
    extern "C" __attribute__((used)) FAR void hidden() { room<40>(); }
    extern "C" void reset() { for (;;) {} }
    extern "C" __attribute__((naked)) void interrupt() { asm volatile("mrs r0, msp\\nb.w hidden"); }
    """,
    "reset: branches through a register, but the compiler recorded no indirect call; call through a pointer": """
    extern "C" void reset() { for (;;) asm volatile("blx r3" ::: "r3", "lr", "memory"); }
    """,
    "reset: uses 8 bytes of stack, but the compiler recorded only 0; do not push in assembler code": """
    extern "C" void reset() { for (;;) asm volatile("push {r0, r1}\\npop {r0, r1}" ::: "memory"); }
    """,
    "reset: moves the stack pointer with 'sub.*'; only push, pop, add a constant or subtract a constant": """
    extern "C" void reset() { for (;;) asm volatile("sub sp, sp, r0" ::: "memory"); }
    """,
    "vector 15: 0x[0-9a-f]+ is not the address of a function; name a handler": """
    extern "C" void reset() { for (;;) {} }
    asm(".global interrupt\\n.set interrupt, 0x08000003");
    """,
    # --- interrupts that are disabled ---
    "interrupts are disabled for 21 instructions; at most 20 are permitted": holding("nop\\n" * 21),
    "0x[0-9a-f]+: interrupts are disabled, and then there is a loop at .*": holding("1: cbz r0, 2f\\nb 1b\\n2: "),
    "0x[0-9a-f]+: interrupts are disabled, and then 0x[0-9a-f]+ makes a call or jump that check-image cannot": """
    FAR void far_away() { room<40>(); }
    extern "C" void reset() {
      for (;;) {
        asm volatile("cpsid i" ::: "memory");
        far_away();
        asm volatile("cpsie i" ::: "memory");
      }
    }
    """,
    "0x[0-9a-f]+: interrupts are disabled, and then 0x[0-9a-f]+ returns": """
    FAR void hold() { asm volatile("cpsid i" ::: "memory"); }
    extern "C" void reset() { for (;;) hold(); }
    """,
    "0x[0-9a-f]+: 'msr PRIMASK, r0' changes an interrupt mask; use cpsid i and cpsie i":
        'extern "C" void reset() { for (;;) asm volatile("msr primask, r0" ::: "memory"); }',
    # --- symbols and sections ---
    "reset, reached by reset: calls missing, which the image does not have; link it": """
    extern "C" __attribute__((weak)) void missing();
    extern "C" void reset() { for (;;) if (missing) missing(); }
    """,
    "section .text: contains the text 'clear both latches of all channels'; an image must not contain it": """
    extern const char text[];
    const char text[] = "clear both latches of all channels";
    volatile char c;
    extern "C" void reset() { for (volatile int i = 0;;) c = text[i]; }
    """,
}


class Refuses(unittest.TestCase):
    def refused(self, reason: str, source: str, **how: str) -> None:
        verdict = check(source, **how)  # type: ignore[arg-type]
        self.assertFalse(verdict.accepted, verdict.figures)
        self.assertRegex(verdict.problems, f"(?m)^image: {reason}")

    def test_an_image_is_refused_with_its_reason(self) -> None:
        for reason, source in REFUSED.items():
            with self.subTest(reason):
                self.refused(reason, source)

    def test_a_stack_frame_of_unknown_size_is_refused(self) -> None:
        source = """
            extern "C" void reset() {{ for (volatile int n = 0;; n = n + 1) {{ {} }} }}
            """
        for frame in (
            "volatile char* p = static_cast<char*>(__builtin_alloca(unsigned(n))); *p = 1;",
            "volatile char a[n]; a[0] = 1;",
        ):
            self.refused(
                "reset, reached by reset: uses an amount of stack that is known only at run time; use objects",
                source.format(frame),
                compile_options="-w",
            )

    def test_a_level_for_an_unknown_handler_is_refused(self) -> None:
        self.refused(
            "--level: no remaining interrupt has the handler timer; name the handler of an interrupt, and only in one"
            " --level",
            'extern "C" void reset() { for (;;) {} }',
            options="--level timer",
        )

    def test_operator_new_and_malloc_are_refused(self) -> None:
        for source in (
            """
            FAR void* operator new(size_t) { return &stack_top; }
            volatile int* volatile p;
            extern "C" void reset() { for (;;) p = new int(1); }
            """,
            """
            extern "C" FAR void* malloc(size_t) { room<8>(); return &stack_top; }
            void* volatile p;
            extern "C" void reset() { for (;;) p = malloc(3); }
            """,
        ):
            self.refused(r"(_Znwj|malloc): heap", source)

    def test_floating_point_is_refused(self) -> None:
        for kind, symbol in (("double", "__aeabi_dmul"), ("float", "__aeabi_fmul")):
            self.refused(
                f"{symbol}: floating point",
                f'volatile {kind} d; extern "C" void reset() {{ for (;;) d = d * d; }}',
                link_options="-lgcc",
            )
        self.refused(
            "__aeabi_ui2d: floating point",
            'volatile double d; volatile unsigned u; extern "C" void reset() { for (;;) d = u; }',
            link_options="-lgcc",
        )

    def test_instructions_of_a_floating_point_unit_are_refused(self) -> None:
        self.refused(
            "the image contains instructions of a floating-point unit; compile with -mfloat-abi=soft",
            'volatile float f; extern "C" void reset() { for (;;) f = f * f; }',
            compile_options="-mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=softfp",
            link_options="-mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=softfp",
        )

    def test_64_bit_division_is_refused(self) -> None:
        for kind in ("int64_t", "uint64_t"):
            self.refused(
                "__aeabi_u?ldivmod: 64-bit division",
                f'volatile {kind} n = 7; extern "C" void reset() {{ for (;;) n = n / (n + 1); }}',
                link_options="-lgcc -lc",
            )

    def test_the_cxx_runtime_is_refused(self) -> None:
        self.refused(
            "__cxa_guard_acquire: the C\\+\\+ run-time library",
            """
            volatile int source;
            extern "C" FAR int __cxa_guard_acquire(void*) { room<8>(); return 1; }
            extern "C" void __cxa_guard_release(void*) {}
            FAR int once() { static int value = source; return value; }
            extern "C" void reset() { for (;;) source = once(); }
            """,
            compile_options="-fthreadsafe-statics",
        )

    def test_globals_initialised_at_run_time_are_refused(self) -> None:
        source = """
            volatile int before;
            volatile int global = before;
            extern "C" void reset() { for (;;) before = global; }
            """
        self.refused("section .init_array: globals initialised at run time", source)
        self.refused(".*unit0.cpp:.*: globals initialised at run time", source, not_in_script=".init_array")

    def test_unwind_tables_are_refused(self) -> None:
        self.refused(
            "section .ARM.exidx: unwind tables",
            'extern "C" void reset() { for (;;) {} } extern "C" void __aeabi_unwind_cpp_pr0() {}',
            compile_options="-funwind-tables",
        )

    def test_undefined_symbols_are_refused(self) -> None:
        self.refused(
            "missing: undefined; link a definition",
            'extern "C" volatile int missing; extern "C" void reset() { for (;;) missing = 1; }',
            link_options="-Wl,--unresolved-symbols=ignore-all",
        )

    def test_an_image_that_requires_too_much_ram_is_refused(self) -> None:
        source = 'volatile char a[20372]; extern "C" void reset() { for (;;) a[0] = 1; }'
        self.assertTrue(check(source).accepted)  # the rest of the RAM is for the frames of three exceptions
        verdict = check(source.replace("20372", "20376"))
        self.assertFalse(verdict.accepted)
        self.assertEqual(verdict.problems, "image: requires 20484 bytes of RAM; the board has 20480\n")


if __name__ == "__main__":
    unittest.main()
