"""Runs an image for the Pico in rp2040js in emulated time. PicoEmulator has the public functions of
emulator.Emulator."""

import contextlib
import os
import pathlib
import subprocess
import tempfile

from instruction_counts.emulator import ROOT, die_with_parent
from instruction_counts.refusal import Refusal, message_of_end, require_file, require_program

# execution.follow recognizes these lines of the log. The image cannot cause such lines.
MARK = "pl011_read addr 0x00000fe0 value 0x00000000"
SYNC_LINE = "pl011_read addr 0x00000fe4 value 0x00000000"

MODULES = ROOT / "build/rp2040js/node_modules"

PINS = "0 1 2 4"  # transmit, receive, driver enable, SDA: boards/pico/module.hpp
SETTINGS_AT = (2048 - 64) * 1024
SETTINGS_SIZE = 64 * 1024


class PicoEmulator:
    """The emulator runs only during `run_for`. `log` is a stream of lines, which a thread must read continuously."""

    @staticmethod
    def check(image, _gate):
        """Raises Refusal if a file or a program is missing."""
        for file in (image, pathlib.Path(image).with_suffix(".bin")):
            require_file(file, "build it with `boards/build-images pico`")
        require_program("node", "nodejs")
        if not MODULES.is_dir():
            raise Refusal(f"{MODULES}: the npm package rp2040js is missing; install it with"
                          " `toolchain/install-npm tests/rp2040 build/rp2040js`")

    def __init__(self, image, _gate):
        self._content = pathlib.Path(image).resolve().with_suffix(".bin")
        self._settings = os.memfd_create("settings")
        os.write(self._settings, b"\xff" * SETTINGS_SIZE)
        self.log = None
        self._process = None

    def power_up(self, pins):
        """Starts the emulator with these pin levels and the stored settings. The emulator executes no instruction
        before `run_for`. Raises Refusal if the emulator ends."""
        reader, writer = os.pipe()
        self._errors = tempfile.TemporaryFile()
        self._process = subprocess.Popen(
            ["node", ROOT / "tests/rp2040/emulator.js"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            env={**os.environ, "NODE_PATH": str(MODULES)},
            pass_fds=(writer, self._settings),
            preexec_fn=die_with_parent,
        )
        os.close(writer)
        self.log = os.fdopen(reader, "rb", buffering=1 << 20)
        try:
            self._ask(f"new {self._content} {PINS}")
        except Refusal:
            self.log.close()
            raise
        self._ask(f"keep-flash {self._settings} {SETTINGS_AT}")
        self._ask(f"trace {writer}")
        for pin, level in pins.items():
            self.set_pin(pin, level)
        self._ask("power on")

    def run_for(self, seconds):
        self._ask(f"run {round(seconds * 1e9)}")

    def put(self, byte):
        """Puts a byte on the line at the baud rate of the module. The image receives it when the emulator continues."""
        counts = dict(word.split("=") for word in self._ask("counts").split())
        self._ask(f"baud {counts['uart']}")
        self._ask(f"queue {byte:02x}")

    def said(self):
        """Returns the bytes that the image has sent since the last call."""
        return bytes.fromhex(self._ask("heard"))

    def mark(self):
        """Writes a line to the log. For execution.follow, this line marks the start of instruction logging. The image
        cannot cause such a line."""
        self._ask(f"note {MARK}")

    def write_sync_line(self):
        """Writes a line to the log. execution.follow calls `seen` of its listener when it reads this line. The image
        cannot cause such a line."""
        self._ask(f"note {SYNC_LINE}")

    def log_instructions(self, on):
        self._ask(f"trace-instructions {'on' if on else 'off'}")

    def set_pin(self, pin, level):
        """Sets the external level of a pin, for example GP14."""
        self._ask(f"pin {pin.removeprefix('GP')} {'high' if level else 'low'}")

    def power_down(self):
        if self._process is None:
            return
        self._process.kill()
        self._process.wait()
        with contextlib.suppress(BrokenPipeError):
            self._process.stdin.close()
        self._process.stdout.close()
        self._errors.close()

    def close(self):
        self.power_down()
        os.close(self._settings)

    def _ask(self, command):
        with contextlib.suppress(BrokenPipeError):  # then there is no reply
            self._process.stdin.write(command.encode() + b"\n")
            self._process.stdin.flush()
        reply = self._process.stdout.readline().decode()
        if not reply:
            raise Refusal(message_of_end(self._process, "node", self._errors))
        state, _, result = reply.rstrip("\n").partition(" ")
        if state != "ok":
            raise RuntimeError(f"{command}: {result}")
        return result
