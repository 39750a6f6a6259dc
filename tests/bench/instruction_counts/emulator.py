"""Runs an image in QEMU in emulated time, with access to its line, its pins, and its execution log."""

import contextlib
import ctypes
import json
import os
import pathlib
import re
import select
import signal
import socket
import struct
import subprocess
import tempfile

from instruction_counts.refusal import Refusal, message_of_end, require_file, require_program

QEMU = "qemu-system-arm"

# QEMU logs these events and the instructions in the order in which they occur.
EVENTS = ["pl011_read", "pl011_write", "nvic_acknowledge_irq", "nvic_complete_irq"]

PORT_A = 8  # /machine/unattached/device[8] is GPIO port A, and the other ports follow
UART_FLAGS = 0x4000C018
RECEIVER_EMPTY = 1 << 4
UART_IDENTIFICATION = 0x4000CFE0  # a register that no image reads
UART_IDENTIFICATION_2 = 0x4000CFE4  # a register that no image reads

# tests/qemu/alarm_clock.cpp explains these addresses and registers.
TIMERS = range(0x40030000, 0x40034000, 0x1000)
ALARM = TIMERS[3]
TIMER_MODE, TIMER_CONTROL, TIMER_MASK, TIMER_CLEAR, TIMER_INTERVAL = 0x04, 0x0C, 0x18, 0x24, 0x28
ALARM_INTERRUPT = 35
VECTORS = 16 + 32  # number of vectors in an image
SET_ENABLE = 0xE000E104  # for interrupts from 32 on
VECTOR_TABLE_OFFSET = 0xE000ED08
DRIVER_ENABLE = 0x40004100
STATUS_LED = 0x40025004
TABLE, TOLD, CODE, ORDERS = 0x20008000, 0x20008000, 0x20009000, 0x2000A000
NEXT_ALARM, EDGES, HALT, LEFT = ORDERS, ORDERS + 4, ORDERS + 20, ORDERS + 24
GATE = CODE + 0x48
HERTZ = 50_000_000
AT_RESET = 4  # clock divisor at reset, relative to HERTZ
INTERRUPT_TAKES = 0.7e-6  # seconds from the alarm to the end of its interrupt, approximately
ROOT = pathlib.Path(__file__).resolve().parents[3]
HANG = 60  # seconds of real time; only detects a hang: even a busy machine needs less


def alarm_code():
    """Returns the interrupt code of AlarmClock in tests/qemu, with its literals."""
    text = (ROOT / "tests/qemu/alarm_interrupt.inc").read_text()
    halfwords = [int(word, 16) for word in re.findall(r"^ *(0x[0-9A-F]{4},(?: 0x[0-9A-F]{4},)?)", text, re.M)
                 for word in re.findall("0x[0-9A-F]{4}", word)]
    halfwords += [0] * (-len(halfwords) % 64)
    literals = (ORDERS, ALARM, UART_FLAGS, DRIVER_ENABLE, STATUS_LED, TOLD)
    return struct.pack(f"<{len(halfwords)}H{len(literals)}I", *halfwords, *literals)


def die_with_parent():
    """Makes the kernel end the calling process when the parent of this process ends. Works only on Linux."""
    set_parent_death_signal = 1
    ctypes.CDLL(None).prctl(set_parent_death_signal, signal.SIGKILL)


class Emulator:
    """The emulated processor runs only during `run_for`. `log` is a stream of lines, which a thread must read
    continuously.

    The emulated time is independent of real time, for example of the time that logging takes: each instruction takes
    8 ns of emulated time. The emulated time stops between calls of `run_for`: this class sets an alarm, and the
    interrupt of the alarm makes the processor wait at a gate (tests/qemu/gate.cpp). execution.follow excludes that
    interrupt. The option -singlestep makes QEMU execute one instruction at a time, so that QEMU logs each one.
    """

    @staticmethod
    def check(image, gate):
        """Raises Refusal if a file or a program is missing."""
        require_file(image, "build it with `boards/build-images lm3s6965evb`")
        require_file(gate, "build it with `cmake --preset host-debug && cmake --build --preset host-debug --target"
                     " ex9000_gate`, or name another one with --gate")
        require_program(QEMU, "qemu-system-arm")

    def __init__(self, image, gate):
        self._image = os.path.abspath(image)
        self._gate = os.path.abspath(gate)
        self._directory = tempfile.TemporaryDirectory(prefix="ex9000-counts-")
        folder = self._directory.name
        with open(f"{folder}/memory", "wb") as file:
            file.write(b"\xff" * 8192)
        self.log = None
        self._process = None
        self._connections = []

    def power_up(self, pins):
        """Starts the emulator with these pin levels and the stored EEPROM content. The emulator executes no instruction
        before `run_for`. Raises Refusal if the emulator ends."""
        folder = self._directory.name
        command = [QEMU, "-machine", "lm3s6965evb", "-display", "none", "-nodefaults", "-nic", "none"]
        command += ["-kernel", self._image, "-S", "-icount", "shift=3,sleep=off", "-singlestep"]
        command += ["-plugin", f"{self._gate},socket=gate,address={GATE}"]
        command += ["-chardev", "socket,id=uart,path=uart", "-serial", "chardev:uart"]
        command += ["-chardev", "socket,id=qmp,path=qmp,mux=on", "-mon", "chardev=qmp,mode=control"]
        command += ["-qtest", "unix:qtest", "-qtest-log", "none"]
        command += ["-drive", "if=none,id=memory,format=raw,file=memory"]
        command += ["-device", "at24c-eeprom,bus=i2c,address=0x50,rom-size=8192,drive=memory", "-D", "log"]
        for event in EVENTS:
            command += ["-trace", event]
        self._errors = open(f"{folder}/errors", "w+b")
        # A new log each time: the thread that reads the previous log may not have ended yet.
        pathlib.Path(f"{folder}/log").unlink(missing_ok=True)
        os.mkfifo(f"{folder}/log")
        self.log = open(os.open(f"{folder}/log", os.O_RDONLY | os.O_NONBLOCK), "rb", buffering=1 << 20)
        with contextlib.ExitStack() as at_the_end:
            # Keeps the log open until QEMU has opened it.
            at_the_end.enter_context(open(f"{folder}/log", "wb"))
            os.set_blocking(self.log.fileno(), True)
            listeners = [
                at_the_end.enter_context(self._listen(f"{folder}/{name}")) for name in ("uart", "qmp", "qtest", "gate")
            ]
            self._process = subprocess.Popen(
                command, cwd=folder, stderr=self._errors, preexec_fn=die_with_parent
            )
            try:
                self._connections = [self._accept(listener) for listener in listeners]
                self.line, self._monitor, self._bus, self._at_gate = self._connections
                self._answers = self._monitor.makefile("rb")
                self._read_answer()  # the greeting, after QEMU has opened the log
            except BaseException:
                self.log.close()
                raise
        for connection in (self._monitor, self._bus, self._at_gate):
            connection.settimeout(HANG)
        self.line.setblocking(False)
        self._bus_answers = self._bus.makefile("rb")
        self._execute("qmp_capabilities")
        for pin, level in pins.items():
            self.set_pin(pin, level)
        self._set_alarm_up()

    @staticmethod
    def _listen(path):
        pathlib.Path(path).unlink(missing_ok=True)
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(path)
        listener.listen(1)
        return listener

    def _accept(self, listener):
        """Waits until QEMU connects, or has ended."""
        ended = os.pidfd_open(self._process.pid)
        try:
            ready, _, _ = select.select([listener, ended], [], [], HANG)
        finally:
            os.close(ended)
        if listener not in ready:
            raise Refusal(self._why())
        return listener.accept()[0]

    def _why(self):
        """Returns a line about the end of QEMU. Kills QEMU if it has not ended."""
        try:
            self._process.wait(1)  # QEMU closes its connections before it ends
        except subprocess.TimeoutExpired:
            self._process.kill()
        return message_of_end(self._process, QEMU, self._errors)

    def _set_alarm_up(self):
        vectors = bytearray.fromhex(self._ask_bus(f"read 0 {VECTORS * 4}").split()[1][2:])
        vectors += bytes(4 * (16 + ALARM_INTERRUPT + 1) - len(vectors))
        struct.pack_into("<I", vectors, 4 * (16 + ALARM_INTERRUPT), CODE | 1)
        self._ask_bus(f"write {TABLE} {len(vectors)} 0x{vectors.hex()}")
        code = alarm_code()
        self._ask_bus(f"write {CODE} {len(code)} 0x{code.hex()}")
        self._write(VECTOR_TABLE_OFFSET, TABLE)
        self._write(ALARM + TIMER_MODE, 1)
        self._write(ALARM + TIMER_MASK, 1)
        self._write(SET_ENABLE, 1 << (ALARM_INTERRUPT - 32))
        self._write(EDGES, 0)
        self._write(HALT, 0)
        self._write(LEFT, 0)
        self._started = False

    def run_for(self, seconds):
        """Runs for about this emulated time, but at least for 2 us."""
        clocks = max(100, round((seconds - INTERRUPT_TAKES) * HERTZ))
        if self._started:
            self._write(NEXT_ALARM, clocks)
            self._at_gate.sendall(b"g")
        else:
            clocks //= AT_RESET
            self._write(ALARM + TIMER_INTERVAL, clocks)
            self._write(ALARM + TIMER_CONTROL, 1)
            self._started = True
            self._execute("cont")
        told = b""
        while len(told) < 4:
            piece = self._at_gate.recv(4 - len(told))
            if not piece:
                raise Refusal(self._why())
            told += piece

    def put(self, byte):
        """Puts a byte on the line. The image receives it when the emulator continues. Raises RuntimeError if the image
        has not read the previous byte."""
        if not self._read(UART_FLAGS) & RECEIVER_EMPTY:
            raise RuntimeError("image: it has not read the previous byte; let more time pass before the next byte")
        self.line.sendall(bytes([byte]))
        while self._read(UART_FLAGS) & RECEIVER_EMPTY:
            pass

    def said(self):
        """Returns the bytes that the image has sent since the last call."""
        try:
            return self.line.recv(4096)
        except BlockingIOError:
            return b""

    def mark(self):
        """Writes a line to the log. For execution.follow, this line marks the start of instruction logging. No image
        causes such a line."""
        self._ask_bus(f"readl {UART_IDENTIFICATION:#x}")

    def write_sync_line(self):
        """Writes a line to the log. execution.follow calls `seen` of its listener when it reads this line. No image
        causes such a line."""
        self._ask_bus(f"readl {UART_IDENTIFICATION_2:#x}")

    def log_instructions(self, on):
        self._execute("human-monitor-command", **{"command-line": "log exec" if on else "log none"})

    def set_pin(self, pin, level):
        """Sets the external level of a pin, for example A7."""
        device = PORT_A + ord(pin[0]) - ord("A")
        self._ask_bus(f"set_irq_in /machine/unattached/device[{device}] unnamed-gpio-in {pin[1]} {level:d}")

    def power_down(self):
        if self._process is None:
            return
        self._process.kill()
        self._process.wait()
        for connection in self._connections:
            connection.close()
        self._errors.close()

    def close(self):
        self.power_down()
        self._directory.cleanup()

    def _execute(self, command, **arguments):
        self._monitor.sendall(json.dumps({"execute": command, "arguments": arguments}).encode() + b"\n")
        while True:
            answer = self._read_answer()
            if "error" in answer:
                raise RuntimeError(f"{command}: {answer['error']['desc']}")
            if "return" in answer:
                return

    def _read_answer(self):
        line = self._answers.readline()
        if not line:
            raise Refusal(self._why())
        return json.loads(line)

    def _write(self, address, word):
        self._ask_bus(f"writel {address:#x} {word:#x}")

    def _read(self, address):
        return int(self._ask_bus(f"readl {address:#x}").split()[1], 16)

    def _ask_bus(self, command):
        self._bus.sendall(command.encode() + b"\n")
        answer = self._bus_answers.readline()
        if not answer:
            raise Refusal(self._why())
        if not answer.startswith(b"OK"):
            raise RuntimeError(f"{command}: {answer}")
        return answer.decode()
