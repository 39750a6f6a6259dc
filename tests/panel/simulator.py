"""Runs ex9000-sim with the panel. Also contains a master that sends Modbus RTU and DCON requests to the simulator."""

import concurrent.futures
import contextlib
import os
import pathlib
import re
import signal
import socket
import subprocess
import tempfile
import threading
import time
import urllib.parse

PROGRAM = os.environ.get(
    "EX9000_SIMULATOR", str(pathlib.Path(__file__).resolve().parents[2] / "build/host-debug/sim/ex9000-sim")
)

HANG = 60  # seconds; only detects a hang: on a busy machine, the slowest reply takes one or two seconds


def wait_until(holds):
    """Waits for a state that no message reports: calls `holds` until its result is true, and returns that result. Fails
    after HANG seconds."""
    gives_up = time.monotonic() + HANG
    while not (it := holds()):
        assert time.monotonic() < gives_up, f"timeout: not true within {HANG} s"
        time.sleep(0.01)  # leaves the processor to the simulator
    return it


class Simulator:
    """A running ex9000-sim. `panel` is the port after --panel: 0 means any free port, None means no port is given.
    `stderr` is the argument of subprocess.Popen."""

    def __init__(self, *arguments, panel=0, stderr=None):
        self._directory = tempfile.TemporaryDirectory()
        self._arguments = arguments
        self._stderr = stderr
        self._start(panel)

    def _start(self, panel):
        self.process = subprocess.Popen(
            [PROGRAM, *self._arguments, "--panel", *([] if panel is None else [str(panel)])],
            stdout=subprocess.PIPE, stderr=self._stderr, text=True, cwd=self._directory.name,
        )
        greeting = ""
        for line in self.process.stdout:
            greeting += line
            if line.startswith("press Ctrl-C"):
                break
        self.address = re.match(r"panel: (\S+)\n", greeting).group(1)
        self.port = urllib.parse.urlsplit(self.address).port
        self.lines = [int(port) for port in re.findall(r"  TCP 127\.0\.0\.1:(\d+)", greeting)]

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        if self.process.stderr:
            self.process.stderr.close()

    def start_again(self, *others):
        """Starts ex9000-sim again, with the same panel port. If `others` is empty, uses the previous arguments;
        otherwise uses `others`. Call `kill` before this method."""
        self._arguments = others or self._arguments
        self._start(self.port)

    def stop(self):
        self.process.send_signal(signal.SIGSTOP)

    def go_on(self):
        self.process.send_signal(signal.SIGCONT)

    def close(self):
        self.kill()
        self._directory.cleanup()


def crc(data):
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0xA001 if value & 1 else 0)
    return value.to_bytes(2, "little")


class Master:
    """A master for Modbus RTU and DCON over TCP."""

    def __init__(self, port):
        self._socket = socket.create_connection(("127.0.0.1", port), timeout=HANG)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def close(self):
        self._socket.close()

    def send(self, data):
        self._socket.sendall(data)

    def ask(self, request, size):
        """Sends a request with its CRC. `request` is in hex and contains no CRC. Returns the PDU of the reply. `size`
        is the number of bytes of the reply, with address and CRC."""
        data = bytes.fromhex(request)
        self._socket.sendall(data + crc(data))
        answer = self._read(size)
        assert crc(answer[:-2]) == answer[-2:], answer.hex()
        return answer[1:-2]

    def _read(self, size):
        answer = b""
        while len(answer) < size:
            piece = self._socket.recv(size - len(answer))
            assert piece, "TCP: the simulator has closed the connection; expected a reply"
            answer += piece
        return answer

    def say(self, command):
        """Sends a DCON command and returns the reply without its CR."""
        self._socket.sendall(command.encode() + b"\r")
        answer = b""
        while not answer.endswith(b"\r"):
            answer += self._read(1)
        return answer[:-1].decode()

    def counter(self, address, channel):
        return int.from_bytes(self.ask(f"{address:02X}04{channel:04X}0001", 7)[2:], "big")

    def coil(self, address, coil, on):
        self.ask(f"{address:02X}05{coil:04X}{'FF00' if on else '0000'}", 8)


@contextlib.contextmanager
def repeating(*actions):
    """Calls each of `actions` repeatedly in its own thread while the `with` block runs. Raises the exception of an
    action after the block."""
    over = threading.Event()

    def repeat(action):
        while not over.is_set():
            action()

    with concurrent.futures.ThreadPoolExecutor() as threads:
        runs = [threads.submit(repeat, action) for action in actions]
        try:
            yield
        finally:
            over.set()
    for run in runs:
        run.result()
