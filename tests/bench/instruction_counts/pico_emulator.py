"""Runs an image for the Pico in rp2040js in emulated time. PicoEmulator has the public functions of
emulator.Emulator."""

import os
import pathlib
import subprocess

from instruction_counts.emulator import ROOT, die_with_parent

# execution.follow recognizes these lines of the log. The image cannot cause such lines.
MARK = "pl011_read addr 0x00000fe0 value 0x00000000"
SYNC_LINE = "pl011_read addr 0x00000fe4 value 0x00000000"

PINS = "0 1 2 4"  # transmit, receive, driver enable, SDA: boards/pico/module.hpp
SETTINGS_AT = (2048 - 64) * 1024
SETTINGS_SIZE = 64 * 1024


class PicoEmulator:
    """The emulator runs only during `run_for`. `log` is a stream of lines, which a thread must read continuously."""

    def __init__(self, image, _gate):
        self._content = pathlib.Path(image).resolve().with_suffix(".bin")
        self._settings = os.memfd_create("settings")
        os.write(self._settings, b"\xff" * SETTINGS_SIZE)
        self.log = None

    def power_up(self, pins):
        """Starts the emulator with these pin levels and the stored settings. The emulator executes no instruction
        before `run_for`."""
        reader, writer = os.pipe()
        self._process = subprocess.Popen(
            ["node", ROOT / "tests/rp2040/emulator.js"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "NODE_PATH": str(ROOT / "build/rp2040js/node_modules")},
            pass_fds=(writer, self._settings),
            preexec_fn=die_with_parent,
        )
        os.close(writer)
        self.log = os.fdopen(reader, "rb", buffering=1 << 20)
        self._ask(f"new {self._content} {PINS}")
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
        self._process.kill()
        self._process.wait()
        self._process.stdin.close()
        self._process.stdout.close()

    def close(self):
        self.power_down()
        os.close(self._settings)

    def _ask(self, command):
        self._process.stdin.write(command.encode() + b"\n")
        self._process.stdin.flush()
        state, _, result = self._process.stdout.readline().decode().rstrip("\n").partition(" ")
        if state != "ok":
            raise RuntimeError(f"{command}: {result or 'the emulator has ended'}")
        return result
