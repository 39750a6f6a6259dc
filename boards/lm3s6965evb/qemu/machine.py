"""The board in QEMU: its processor is started, told of INIT* before the first instruction, and ended.

QEMU knows no pull-ups: an input that nobody drives is low, and every reset of the machine lets go of all inputs. So a
reset that the image itself asks for, or its watchdog, is turned into a stop, and done here.
"""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import signal
import socket
import subprocess
import tempfile
import time
from collections import deque
from pathlib import Path
from typing import Any

from qemu.refusal import Refusal

_PROGRAM = "qemu-system-arm"
_INIT_RELEASED = "set_irq_in /machine/unattached/device[8] unnamed-gpio-in 7 1"  # PA7 high
_UART0_CONTROL = 0x4000C030
_DRIVER_ENABLE = 0x40004100  # PA6 alone, high while the module speaks
_PR_SET_PDEATHSIG = 1
_HANG = 60  # seconds; only a QEMU or an image that hangs takes so long, also on a host that is busy with other things


class Ended(Exception):
    """QEMU runs no more."""


class Machine:
    """`line` is what the module says, non-blocking; when `events` is readable, call `take_events`."""

    def __init__(self, image: Path, eeprom: int, init_grounded: bool, gdb_port: int | None) -> None:
        self._init_grounded = init_grounded
        self.line, line = socket.socketpair()
        self.events, monitor = socket.socketpair()
        self._test_port, test_port = socket.socketpair()
        self._unread = b""
        self._unsaid = b""
        self._untaken: deque[dict[str, Any]] = deque()
        self._errors = tempfile.TemporaryFile()
        words = [_PROGRAM, "-M", "lm3s6965evb", "-display", "none", "-nodefaults", "-S"]
        words += ["-icount", "shift=3"]  # 8 ns an instruction: time is not the host's to distort
        words += ["-action", "reboot=shutdown,shutdown=pause", "-kernel", str(image)]
        words += ["-chardev", f"socket,id=line,fd={line.fileno()}", "-serial", "chardev:line"]
        words += ["-chardev", f"socket,id=monitor,fd={monitor.fileno()}", "-mon", "monitor,mode=control"]
        words += ["-chardev", f"socket,id=qtest,fd={test_port.fileno()}"]
        words += ["-qtest", "chardev:qtest", "-qtest-log", "none"]
        words += ["-drive", f"if=none,id=eeprom,format=raw,file=/dev/fd/{eeprom}"]
        words += ["-device", "at24c-eeprom,bus=i2c,address=0x50,rom-size=8192,drive=eeprom"]
        if gdb_port is not None:
            words += ["-gdb", f"tcp:127.0.0.1:{gdb_port}"]
        self._process = self._start(words, [line.fileno(), monitor.fileno(), test_port.fileno(), eeprom])
        for socket_of_qemu in (line, monitor, test_port):
            socket_of_qemu.close()
        self.line.setblocking(False)
        try:
            self._next_message()  # the greeting
            self._command("qmp_capabilities")
            self._run()
            self._wait_until_listening()
        except BaseException:
            self.end()
            raise

    def _start(self, words: list[str], descriptors: list[int]) -> subprocess.Popen[bytes]:
        libc = ctypes.CDLL(None)
        try:
            # In a session of its own, so that Ctrl-C reaches it through `end` alone.
            return subprocess.Popen(
                words,
                stdin=subprocess.DEVNULL,
                stdout=self._errors,
                stderr=self._errors,
                pass_fds=descriptors,
                start_new_session=True,
                preexec_fn=lambda: libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL),
            )
        except FileNotFoundError as error:
            raise Refusal(f"{_PROGRAM} is missing; install the package {_PROGRAM}") from error

    def say(self, data: bytes) -> None:
        """Puts a master's bytes on the line, by `go_on`, once the module's driver is off.

        QEMU's UART sends in no time, so a reply is with the master before the driver goes off, and a master that is
        quick to go on would not be heard. On a wire it could not be that quick.
        """
        self._unsaid += data

    def hear(self) -> bytes:
        """What the module says; while `line` is readable."""
        return self._received_from(self.line)

    @property
    def go_on_within(self) -> float:
        """Seconds until `go_on` is due."""
        return 0.001 if self._unsaid else 0.1

    def go_on(self) -> None:
        """What the module does not take is lost, as on a wire. Does not wait.

        To be called even where there is nothing to say: of a module that hangs QEMU may forget the time, and so the
        watchdog that is to reset it, unless somebody asks for something.
        """
        speaking = self._word_at(_DRIVER_ENABLE)
        if self._unsaid and not speaking:
            with contextlib.suppress(BlockingIOError, BrokenPipeError):
                self.line.send(self._unsaid)
            self._unsaid = b""

    def take_events(self) -> None:
        """Resets the machine where the module has asked for it."""
        self._untaken.append(self._next_message())
        while self._untaken or b"\n" in self._unread:
            event = self._untaken.popleft() if self._untaken else self._next_message()
            if event.get("event") == "SHUTDOWN" and event["data"]["reason"] == "guest-reset":
                self._reset()

    def end(self) -> None:
        """At once, and waits for it."""
        with contextlib.suppress(OSError):
            self.events.sendall(b'{"execute": "quit"}\n')
        try:
            self._process.wait(_HANG)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _reset(self) -> None:
        self._command("set-action", reboot="reset")
        self._command("system_reset")
        while not any(event["event"] == "RESET" for event in self._untaken):
            self._untaken.append(self._next_message())
        self._command("set-action", reboot="shutdown")
        self._run()

    def _run(self) -> None:
        if not self._init_grounded:
            self._test(_INIT_RELEASED)
        self._command("cont")

    def _wait_until_listening(self) -> None:
        """A byte that comes before the UART is enabled is lost, and who opens a line wants it to be there."""
        deadline = time.monotonic() + _HANG
        while not self._word_at(_UART0_CONTROL) & 1:
            if time.monotonic() > deadline:
                raise Refusal("the image does not enable its UART; is it one of this firmware?")
            time.sleep(0.001)

    def _command(self, name: str, **arguments: str) -> None:
        self._send(self.events, json.dumps({"execute": name, "arguments": arguments}))
        message = self._next_message()
        while "event" in message:
            self._untaken.append(message)
            message = self._next_message()
        if "error" in message:
            raise Ended(f"{_PROGRAM} refuses {name}: {message['error']['desc']}")

    def _word_at(self, address: int) -> int:
        return int(self._test(f"readl {address:#x}").split()[1], 16)

    def _test(self, command: str) -> str:
        self._send(self._test_port, command)
        reply = b""
        while not reply.endswith(b"\n"):
            reply += self._received_from(self._test_port)
        return reply.decode()

    def _next_message(self) -> dict[str, Any]:
        while b"\n" not in self._unread:
            self._unread += self._received_from(self.events)
        line, self._unread = self._unread.split(b"\n", 1)
        message: dict[str, Any] = json.loads(line)
        return message

    def _send(self, connection: socket.socket, line: str) -> None:
        try:
            connection.sendall(line.encode() + b"\n")
        except BrokenPipeError as error:
            raise Ended(self._last_words()) from error

    def _received_from(self, connection: socket.socket) -> bytes:
        try:
            data = connection.recv(65536)
        except ConnectionResetError:
            data = b""
        if not data:
            raise Ended(self._last_words())
        return data

    def _last_words(self) -> str:
        status = self._process.wait()
        self._errors.seek(0, os.SEEK_SET)
        lines = self._errors.read().decode(errors="replace").splitlines()
        why = [line for line in lines if line.startswith(_PROGRAM) and "warning" not in line]
        how = f"signal {-status}" if status < 0 else f"status {status}"
        return f"{_PROGRAM} has ended with {how}" + (f": {why[-1]}" if why else "")
