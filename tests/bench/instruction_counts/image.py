"""Reads a firmware image: its vectors, and where it sleeps."""

import struct
import subprocess

from instruction_counts.refusal import Refusal, require_program


class Image:
    """An ELF file, read with the arm-none-eabi tools."""

    def __init__(self, path):
        self.path = path

    @staticmethod
    def _tool(name, *arguments, text=None):
        command = [f"arm-none-eabi-{name}", *arguments]
        require_program(command[0], "binutils-arm-none-eabi")
        finished = subprocess.run(command, input=text, capture_output=True, check=False)
        if finished.returncode != 0:
            why = finished.stderr.decode(errors="replace").strip().partition("\n")[0]
            raise Refusal(f"{why or command[0]}; name the ELF file of an image")
        return finished.stdout

    def handlers(self):
        """Returns the address of the first instruction of each exception handler, by exception number."""
        table = self._tool("objcopy", "-O", "binary", "-j", ".vectors", self.path, "/dev/stdout")
        words = struct.unpack(f"<{len(table) // 4}I", table)
        return {number: word & ~1 for number, word in enumerate(words) if number >= 1}

    def sleeps(self):
        """Returns the addresses of the WFI instructions, where the main loop sleeps."""
        lines = self._tool("objdump", "-d", self.path).decode().splitlines()
        return {int(line.split(":")[0], 16) for line in lines if line.endswith("\twfi")}
