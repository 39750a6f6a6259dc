"""Starts and ends the board in QEMU, and passes bytes between the master and the module.

Unless INIT* is grounded, `Machine` sets INIT* high before the first instruction. QEMU emulates no pull-ups: an input
that is not driven is low, and each reset of the board makes all inputs low. Therefore, if the image or its watchdog
requests a reset, QEMU pauses and does not reset the board. `Machine` then resets the board and, unless INIT* is
grounded, sets INIT* high again.
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

from emulated.program import Ended
from emulated.refusal import Refusal

_PROGRAM = "qemu-system-arm"
_INIT_RELEASED = "set_irq_in /machine/unattached/device[8] unnamed-gpio-in 7 1"  # PA7 high
_UART0_CONTROL = 0x4000C030
_DRIVER_ENABLE = 0x40004100  # an address that reads only PA6, which is high while the module sends
_PR_SET_PDEATHSIG = 1
# A time in seconds of the host's clock. A started image must enable its UART within this time, and QEMU must end within
# this time after the command `quit`. The time is long enough for a busy host.
_HANG = 60


class Machine:
    """A module in QEMU."""

    def __init__(self, image: Path, eeprom: int, init_grounded: bool, gdb_port: int | None) -> None:
        self._image = image
        self._init_grounded = init_grounded
        self._line, line = socket.socketpair()
        self._events, monitor = socket.socketpair()
        self.watched = [self._line.fileno(), self._events.fileno()]
        self._test_port, test_port = socket.socketpair()
        self._unread = b""
        self._queued_bytes = b""
        self._pending_events: deque[dict[str, Any]] = deque()
        self._errors = tempfile.TemporaryFile()
        words = [_PROGRAM, "-M", "lm3s6965evb", "-display", "none", "-nodefaults", "-S"]
        words += ["-icount", "shift=3"]  # 8 ns of virtual time per instruction, even if the host is slow
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
        self._line.setblocking(False)
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
            # QEMU gets its own session, so that Ctrl-C does not reach it; `end` ends it.
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
            raise Refusal(f"{_PROGRAM}: the program is missing; install the package {_PROGRAM}") from error

    @property
    def carry_within(self) -> float:
        """Returns the time in seconds within which `carry` must be called."""
        return 0.001 if self._queued_bytes else 0.1

    def carry(self, requests: bytes, ready: list[int]) -> bytes:
        """Takes bytes of the master and returns bytes of the module. `ready` must contain the descriptors of `watched`
        that are readable.

        Does not wait for bytes of the master or of the module, because QEMU hangs while the socket for the bytes of
        the UART is full. Raises Ended if QEMU has ended or has reported an error.
        """
        if self._events.fileno() in ready:
            self._take_events()
        reply = self._received_from(self._line) if self._line.fileno() in ready else b""
        # QEMU's UART sends without delay, so the master gets a reply before the module disables its driver. Without
        # the queue `_queued_bytes`, the module would lose the next request of a fast master. On a real line, the module
        # disables its driver shortly after the last stop bit.
        self._queued_bytes += requests
        self._send_queued()
        return reply

    def _send_queued(self) -> None:
        """Sends queued bytes if the module's driver is off. Bytes that do not fit into the buffer of the socket are
        lost. On a real line, bytes that the module does not receive are also lost.

        Call this even if nothing is queued, because it always sends a command to QEMU. If the module hangs, QEMU's
        virtual time may stop until QEMU gets a command. Without such a command, the watchdog would not reset the
        module.
        """
        speaking = self._word_at(_DRIVER_ENABLE)
        if self._queued_bytes and not speaking:
            with contextlib.suppress(BlockingIOError, BrokenPipeError):
                self._line.send(self._queued_bytes)
            self._queued_bytes = b""

    def _take_events(self) -> None:
        """Waits for an event of QEMU and processes all received events. Resets the board if the image or its watchdog
        has requested a reset."""
        self._pending_events.append(self._next_message())
        while self._pending_events or b"\n" in self._unread:
            event = self._pending_events.popleft() if self._pending_events else self._next_message()
            if event.get("event") == "SHUTDOWN" and event["data"]["reason"] == "guest-reset":
                self._reset()

    def end(self) -> None:
        """Ends QEMU and waits for its end. Kills QEMU if it has not ended after 60 s."""
        with contextlib.suppress(OSError):
            self._events.sendall(b'{"execute": "quit"}\n')
        try:
            self._process.wait(_HANG)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _reset(self) -> None:
        self._command("set-action", reboot="reset")
        self._command("system_reset")
        while not any(event["event"] == "RESET" for event in self._pending_events):
            self._pending_events.append(self._next_message())
        self._command("set-action", reboot="shutdown")
        self._run()

    def _run(self) -> None:
        if not self._init_grounded:
            self._test(_INIT_RELEASED)
        self._command("cont")

    def _wait_until_listening(self) -> None:
        """Waits until the image enables the UART, because the UART loses earlier bytes. Raises Refusal after 60 s."""
        deadline = time.monotonic() + _HANG
        while not self._word_at(_UART0_CONTROL) & 1:
            if time.monotonic() > deadline:
                raise Refusal(
                    f"{self._image}: the image does not enable its UART within {_HANG} s; "
                    "name an image of this firmware"
                )
            time.sleep(0.001)

    def _command(self, name: str, **arguments: str) -> None:
        self._send(self._events, json.dumps({"execute": name, "arguments": arguments}))
        message = self._next_message()
        while "event" in message:
            self._pending_events.append(message)
            message = self._next_message()
        if "error" in message:
            raise Ended(f"{_PROGRAM}: the command {name} fails: {message['error']['desc']}; install QEMU 7.2 or later")

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
            self._unread += self._received_from(self._events)
        line, self._unread = self._unread.split(b"\n", 1)
        message: dict[str, Any] = json.loads(line)
        return message

    def _send(self, connection: socket.socket, line: str) -> None:
        try:
            connection.sendall(line.encode() + b"\n")
        except BrokenPipeError as error:
            raise Ended(self._exit_message()) from error

    def _received_from(self, connection: socket.socket) -> bytes:
        try:
            data = connection.recv(65536)
        except ConnectionResetError:
            data = b""
        if not data:
            raise Ended(self._exit_message())
        return data

    def _exit_message(self) -> str:
        status = self._process.wait()
        self._errors.seek(0, os.SEEK_SET)
        lines = self._errors.read().decode(errors="replace").splitlines()
        why = [line for line in lines if line.startswith(_PROGRAM) and "warning" not in line]
        how = f"signal {-status}" if status < 0 else f"status {status}"
        if not why:
            return f"{_PROGRAM}: the emulator has ended with {how}; start it again"
        cause = why[-1].removeprefix(f"{_PROGRAM}: ")
        return f"{_PROGRAM}: the emulator has ended with {how}: {cause}; remove the cause and start it again"
