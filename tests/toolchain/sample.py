"""Compiles and links snippets of C++ to small images, and runs check-image on these images."""

from __future__ import annotations

import struct
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

_HERE = Path(__file__).resolve().parent
_TOOL = _HERE.parents[1] / "toolchain" / "check-image"
_COMPILE = (
    f"{_TOOL.with_name('with-call-graph')} arm-none-eabi-g++ -std=c++17 -mcpu=cortex-m3 -mthumb -Os"
    " -ffreestanding -fno-exceptions -fno-rtti"
    " -ffunction-sections -fdata-sections -fno-threadsafe-statics -fno-unwind-tables"
    " -fno-asynchronous-unwind-tables"
).split()
_LINK = "arm-none-eabi-g++ -mcpu=cortex-m3 -mthumb -nostdlib -Wl,--gc-sections,--no-warn-rwx-segments".split()

# `room<N>()` adds an array of N bytes to the stack frame of the function that calls it.
PRELUDE = """
#include <stddef.h>
#include <stdint.h>
using Handler = void (*)();
extern "C" uint32_t stack_top;
extern "C" void reset();
extern "C" void interrupt();
extern "C" void fault();
#define FAR __attribute__((noinline, noclone))
template <unsigned size> inline __attribute__((always_inline)) void room() {
  volatile unsigned char bytes[size];
  bytes[0] = 1;
}
"""
NO_INTERRUPT = """
extern "C" void interrupt() {}
"""
# The vector table of an image with one interrupt.
VECTORS = """
extern "C" void fault() { for (;;) {} }
[[gnu::section(".vectors"), gnu::used]] const Handler vectors[] = {
    reinterpret_cast<Handler>(&stack_top), reset, fault, fault, nullptr, nullptr, nullptr, nullptr,
    nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, interrupt};
"""


@dataclass(frozen=True)
class Verdict:
    accepted: bool
    figures: str
    problems: str


def check(
    source: str,
    *more_sources: str,
    options: str = "",
    compile_options: str = "",
    link_options: str = "",
    not_in_script: str = "",
) -> Verdict:
    """Builds an image from the sources and runs check-image on it with `options`. Each source becomes a translation
    unit, which begins with PRELUDE. Adds the vector table to `source`. If `source` does not contain the text
    `interrupt`, also adds an empty interrupt handler to it. If `not_in_script` is not empty, removes the lines that
    contain this text from the linker script. Raises AssertionError if the compiler or the linker fails."""
    vectors = VECTORS if "interrupt" in source else NO_INTERRUPT + VECTORS
    with tempfile.TemporaryDirectory(prefix="check-image-") as folder:
        objects = []
        for number, text in enumerate((source + vectors, *more_sources)):
            cpp = Path(folder, f"unit{number}.cpp")
            cpp.write_text(PRELUDE + text, encoding="utf-8")
            objects.append(str(cpp.with_suffix(".cpp.o")))
            _run([*_COMPILE, *compile_options.split(), "-c", str(cpp), "-o", objects[-1]])
        image = str(Path(folder, "image.elf"))
        lines = (_HERE / "image.ld").read_text(encoding="utf-8").splitlines(keepends=True)
        script = Path(folder, "image.ld")
        script.write_text("".join(line for line in lines if not not_in_script or not_in_script not in line), "utf-8")
        _run([*_LINK, "-T", str(script), *objects, *link_options.split(), "-o", image])
        done = subprocess.run(
            [str(_TOOL), image, *objects, *options.split()],
            capture_output=True,
            text=True,
            check=False,
        )
    return Verdict(done.returncode == 0, done.stdout, done.stderr)


def elf(*segments: tuple[int, bytes]) -> bytes:
    """Returns an ELF file with loadable segments. `segments`: the load address and the content of each."""
    header = 52 + 32 * len(segments)
    table, content = b"", b""
    for address, data in segments:
        table += struct.pack("<8I", 1, header + len(content), 0x20000000, address, len(data), len(data), 5, 4)
        content += data
    fields = (2, 40, 1, 0, 52, 0, 0, 52, 32, len(segments), 0, 0, 0)
    return b"\x7fELF\x01\x01".ljust(16, b"\0") + struct.pack("<2H5I6H", *fields) + table + content


def uf2(begin: int, content: bytes) -> bytes:
    """Returns a UF2 file with pages from an address on."""
    pages = [content[start : start + 256] for start in range(0, len(content), 256)]
    file = b""
    for number, page in enumerate(pages):
        header = (0x0A324655, 0x9E5D5157, 0x2000, begin + 256 * number, len(page), number, len(pages), 0xE48BFF56)
        file += struct.pack("<8I", *header) + page.ljust(476, b"\0") + struct.pack("<I", 0x0AB16F30)
    return file


def record(kind: int, address: int, data: bytes) -> bytes:
    """Returns a line of a HEX file."""
    content = bytes([len(data)]) + address.to_bytes(2, "big") + bytes([kind]) + data
    return b":" + (content + bytes([-sum(content) % 256])).hex().upper().encode() + b"\r\n"


def hex_file(begin: int, content: bytes) -> bytes:
    """Returns a HEX file with data from an address on, a multiple of 16."""
    file = b""
    for start in range(0, len(content), 16):
        high, low = divmod(begin + start, 0x10000)
        if start == 0 or low == 0:
            file += record(4, 0, high.to_bytes(2, "big"))
        file += record(0, low, content[start : start + 16])
    return file + record(5, 0, bytes(4)) + record(1, 0, b"")


def holding(code: str) -> str:
    """Returns a source that disables interrupts before the assembly code in `code` and enables them after it."""
    return f"""
        extern "C" void reset() {{ for (;;) asm volatile("cpsid i\\n{code}cpsie i" ::: "memory"); }}
        """


def _run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(command)}:\n{done.stderr}")
