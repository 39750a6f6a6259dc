"""Reads a firmware image: its functions, its vectors, and the functions inlined at each address."""

import bisect
import struct
import subprocess

from instruction_counts.refusal import Refusal, require_program


class Image:
    """An ELF file, read with the arm-none-eabi tools."""

    def __init__(self, path):
        self.path = path
        self._functions = []
        for line in self._tool("nm", "-CSn", path).decode().splitlines():
            fields = line.split(" ", 3)
            if len(fields) == 4 and fields[2] in "tT":
                begin = int(fields[0], 16)
                self._functions.append((begin, begin + int(fields[1], 16), fields[3]))
        self._begins = [begin for begin, _, _ in self._functions]
        self._chains = {}

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

    def function(self, address):
        """Returns the name of the function that contains the address. Returns the address as a hexadecimal text if no
        function contains it."""
        index = bisect.bisect_right(self._begins, address) - 1
        if index >= 0 and address < self._functions[index][1]:
            return self._functions[index][2]
        return hex(address)

    def inlined(self, addresses):
        """Returns a dictionary. Its keys are the addresses. Each value is a list of the names of the source functions
        that contain the address. The innermost function is first."""
        unknown = sorted(set(addresses) - set(self._chains))
        text = "\n".join(map(hex, unknown)).encode()
        chain = []
        is_name = True
        for line in self._tool("addr2line", "-afiC", "-e", self.path, text=text).decode().splitlines():
            if line.startswith("0x"):
                chain = self._chains.setdefault(int(line, 16), [])
                is_name = True
            else:
                if is_name:
                    chain.append(line)
                is_name = not is_name
        return {address: self._chains[address] for address in addresses}
