"""Runs a Pico in rp2040js. The virtual time of the Pico follows the clock of the host.

tests/rp2040/emulator.js is the emulator. It executes one command for each line of its input. Virtual time passes only
during commands such as `run`.
"""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import tempfile
import time
from pathlib import Path

from emulated.program import Ended
from emulated.refusal import Refusal

_ROOT = Path(__file__).resolve().parents[3]
_EMULATOR = _ROOT / "tests/rp2040/emulator.js"
_PACKAGES = _ROOT / "build/rp2040js/node_modules"
_PR_SET_PDEATHSIG = 1

# GPIO numbers, and the offset of the settings in the flash: boards/pico/module.hpp and every_pico.hpp.
_TRANSMIT, _RECEIVE, _DRIVER_ENABLE, _INIT, _EEPROM_DATA = range(5)
_SETTINGS_IN_FLASH = (2048 - 64) * 1024

_COMES_UP_WITHIN = 100_000_000  # ns, wire.md section 2
_NANOSECONDS = 1_000_000_000
_LARGEST_LAG = 0.1  # seconds


class Machine:
    """A module on a Pico in rp2040js. After `__init__`, only `carry` lets virtual time pass."""

    def __init__(self, image: int, settings: int, eeprom: int, init_grounded: bool, has_driver_enable: bool) -> None:
        """Starts the emulator and the module, and lets 100 ms of virtual time pass. `image`, `settings` and `eeprom`
        are descriptors of three files: the flash from its first byte on, the settings at the end of the flash, and the
        EEPROM. `init_grounded`: whether INIT* is tied to GND. `has_driver_enable`: if not, the transceiver switches its
        direction automatically.

        Raises Refusal if rp2040js or Node.js is missing. Raises Ended if the emulator ends or reports an error.
        """
        self.watched: list[int] = []
        self._errors = tempfile.TemporaryFile()
        self._process = self._start([image, settings, eeprom])
        try:
            driver_enable = _DRIVER_ENABLE if has_driver_enable else "none"
            pins = (_TRANSMIT, _RECEIVE, driver_enable, _EEPROM_DATA)
            self._ask("new", f"/dev/fd/{image}", *pins)
            self._ask("keep-flash", settings, _SETTINGS_IN_FLASH)
            self._ask("keep-eeprom", eeprom)
            if init_grounded:
                self._ask("pin", _INIT, "low")
            self._ask("power", "on")
            self._ask("run", _COMES_UP_WITHIN)
            self._ask("heard")
        except BaseException:
            self.end()
            raise
        self._began = time.monotonic() - _COMES_UP_WITHIN / _NANOSECONDS
        self._passed = _COMES_UP_WITHIN
        self._last_byte = 0.0

    def _start(self, descriptors: list[int]) -> subprocess.Popen[bytes]:
        if not _PACKAGES.is_dir():
            raise Refusal(
                "rp2040js: the package is missing; install it with"
                " `toolchain/install-npm tests/rp2040 build/rp2040js`"
            )
        libc = ctypes.CDLL(None)
        try:
            # The emulator gets its own session, so that Ctrl-C does not reach the emulator. `end` ends the emulator.
            return subprocess.Popen(
                ["node", str(_EMULATOR)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._errors,
                env={**os.environ, "NODE_PATH": str(_PACKAGES)},
                pass_fds=descriptors,
                start_new_session=True,
                preexec_fn=lambda: libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL),
            )
        except FileNotFoundError as error:
            raise Refusal("node: the program is missing; install the package nodejs") from error

    @property
    def carry_within(self) -> float:
        """Returns the time in seconds within which `carry` must be called. This time is shorter for one second after
        a byte."""
        return 0.002 if time.monotonic() - self._last_byte < 1 else 0.02

    def carry(self, requests: bytes, _ready: list[int]) -> bytes:
        """Lets virtual time pass up to the time of the host, and then begins to send `requests`, the bytes of the
        master. The module receives them during later calls. Returns the bytes that the module has sent since the last
        call.

        Raises Ended if the emulator has ended or reports an error.
        """
        now = time.monotonic()
        due = round((now - self._began) * _NANOSECONDS)
        # If virtual time is more than _LARGEST_LAG behind the time of the host, the lag above _LARGEST_LAG is skipped.
        # Without this limit, the module would run faster than real time for too long.
        lag = due - self._passed - _LARGEST_LAG * _NANOSECONDS
        if lag > 0:
            self._began += lag / _NANOSECONDS
            due -= round(lag)
        if due > self._passed:
            self._ask("run", due - self._passed)
            self._passed = due
        reply = bytes.fromhex(self._ask("heard"))
        if requests:
            self._follow_baud_rate()
            self._ask("queue", requests.hex())
        if requests or reply:
            self._last_byte = now
        return reply

    def end(self) -> None:
        """Ends the emulator and waits for its end."""
        self._process.kill()
        self._process.wait()

    def _follow_baud_rate(self) -> None:
        """Sets the master to the baud rate of the module, so that the user does not need to know this rate. Does
        nothing while the module's UART is off."""
        counts = dict(word.split("=") for word in self._ask("counts").split())
        if counts["uart"] != "0":
            self._ask("baud", counts["uart"])

    def _ask(self, *words: str | int) -> str:
        """Sends a command to the emulator and returns its result. Raises Ended if the emulator has ended, or if it
        reports an error."""
        assert self._process.stdin and self._process.stdout
        try:
            self._process.stdin.write(" ".join(map(str, words)).encode() + b"\n")
            self._process.stdin.flush()
        except BrokenPipeError as error:
            raise Ended(self._exit_message()) from error
        reply = self._process.stdout.readline().decode()
        if not reply:
            raise Ended(self._exit_message())
        state, _, result = reply.rstrip("\n").partition(" ")
        if state != "ok":
            raise Ended(
                f"rp2040js: the emulator rejects an operation of the image: {result}; name an image of this firmware"
            )
        return result

    def _exit_message(self) -> str:
        status = self._process.wait()
        self._errors.seek(0, os.SEEK_SET)
        lines = [line for line in self._errors.read().decode(errors="replace").splitlines() if "Error" in line]
        how = f"signal {-status}" if status < 0 else f"status {status}"
        if not lines:
            return f"node: the emulator has ended with {how}; start it again"
        return f"node: the emulator has ended with {how}: {lines[-1]}; remove the cause and start it again"
