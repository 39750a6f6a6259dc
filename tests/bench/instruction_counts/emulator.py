"""An image in QEMU: its line, its pins, and the log of what it executes."""

import ctypes
import json
import os
import signal
import socket
import subprocess
import tempfile

# What is logged beside instructions, in the order in which it happens.
EVENTS = ["pl011_read", "pl011_write", "i2c_event", "nvic_acknowledge_irq", "nvic_complete_irq"]

PORT_A = 8  # /machine/unattached/device[8] is GPIO port A, and the others follow
UART_IDENTIFICATION = 0x4000CFE0  # a register that no firmware reads


def die_with_parent():
    """So that nothing is left where somebody interrupts this; Linux only."""
    set_parent_death_signal = 1
    ctypes.CDLL(None).prctl(set_parent_death_signal, signal.SIGKILL)


class Emulator:
    """Halted until `run`. `log` is a stream of lines that somebody has to read all the time.

    -icount: while the image executes, its clock advances by 8 ns an instruction, however long logging takes.
    -singlestep: one instruction at a time, so that each one is logged.
    """

    def __init__(self, image):
        self._directory = tempfile.TemporaryDirectory(prefix="ex9000-counts-")
        folder = self._directory.name
        with open(f"{folder}/memory", "wb") as file:
            file.write(b"\xff" * 8192)
        os.mkfifo(f"{folder}/log")
        listeners = [self._listen(f"{folder}/{name}") for name in ("uart", "qmp", "qtest")]
        command = [
            "qemu-system-arm",
            "-machine",
            "lm3s6965evb",
            "-display",
            "none",
            "-nodefaults",
            "-nic",
            "none",
            "-kernel",
            os.path.abspath(image),
            "-S",
            "-icount",
            "shift=3",
            "-singlestep",
            "-chardev",
            "socket,id=uart,path=uart",
            "-serial",
            "chardev:uart",
            "-qmp",
            "unix:qmp",
            "-qtest",
            "unix:qtest",
            "-qtest-log",
            "none",
            "-drive",
            "if=none,id=memory,format=raw,file=memory",
            "-device",
            "at24c-eeprom,bus=i2c,address=0x50,rom-size=8192,drive=memory",
            "-D",
            "log",
        ]
        for event in EVENTS:
            command += ["-trace", event]
        self._process = subprocess.Popen(
            command, cwd=folder, stderr=subprocess.DEVNULL, preexec_fn=die_with_parent
        )
        self.log = open(f"{folder}/log", "rb", buffering=1 << 20)
        self.line, self._monitor, self._bus = (listener.accept()[0] for listener in listeners)
        for listener in listeners:
            listener.close()
        self._answers = self._monitor.makefile("rb")
        self._bus_answers = self._bus.makefile("rb")
        self._answers.readline()
        self._execute("qmp_capabilities")

    @staticmethod
    def _listen(path):
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(path)
        listener.listen(1)
        listener.settimeout(20)
        return listener

    def run(self):
        self._execute("cont")

    def halt(self):
        self._execute("stop")

    def reset(self):
        """The EEPROM keeps what it holds."""
        self._execute("system_reset")

    def mark(self):
        """Leaves a line in the log that is nothing of the image's: see execution.py."""
        self._ask_bus(f"readl {UART_IDENTIFICATION:#x}")

    def log_instructions(self, on):
        self._execute("human-monitor-command", **{"command-line": "log exec" if on else "log none"})

    def set_pin(self, pin, level):
        """The level outside a pin, such as A7."""
        device = PORT_A + ord(pin[0]) - ord("A")
        self._ask_bus(f"set_irq_in /machine/unattached/device[{device}] unnamed-gpio-in {pin[1]} {level:d}")

    def close(self):
        self._process.kill()
        self._process.wait()
        for connection in (self.line, self._monitor, self._bus):
            connection.close()
        self._directory.cleanup()

    def _execute(self, command, **arguments):
        self._monitor.sendall(json.dumps({"execute": command, "arguments": arguments}).encode() + b"\n")
        while True:
            answer = json.loads(self._answers.readline())
            if "error" in answer:
                raise RuntimeError(f"{command}: {answer['error']['desc']}")
            if "return" in answer:
                return

    def _ask_bus(self, command):
        self._bus.sendall(command.encode() + b"\n")
        answer = self._bus_answers.readline()
        if not answer.startswith(b"OK"):
            raise RuntimeError(f"{command}: {answer}")
