"""A simulated module, and a master that reads its coils, discrete inputs and registers, and writes its coils."""

import re
import socket
import struct
import subprocess

from program import PROGRAM

FUNCTION_OF_READING = {"coil": 1, "discrete_input": 2, "holding": 3, "input": 4}


class Line:
    """One module at address 01, which a master reaches over Modbus TCP.

    `read` and `write_coil` raise OSError if the simulator has ended or sends nothing for 60 s.
    """

    def __init__(self, model):
        command = [PROGRAM, f"{model}@01", "--port", "modbus-tcp:0", "--timing", "instant"]
        self._program = subprocess.Popen(command, stdout=subprocess.PIPE, encoding="utf-8")
        self.port = self._port()
        self._socket = socket.create_connection(("127.0.0.1", self.port), timeout=60)  # seconds; only detects a hang
        self._transaction = 0

    def _port(self):
        """Reads the greeting and returns the port in it."""
        greeting = ""
        while not greeting.endswith("press Ctrl-C to end\n"):
            line = self._program.stdout.readline()
            if not line:
                raise ConnectionError(f"the simulator has ended: {greeting}")
            greeting += line
        return int(re.search(r"TCP 127\.0\.0\.1:(\d+)", greeting).group(1))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._socket.close()
        self._program.terminate()
        self._program.wait()
        self._program.stdout.close()

    def _receive(self, count):
        data = b""
        while len(data) < count:
            received = self._socket.recv(count - len(data))
            if not received:
                raise ConnectionError("the simulator has ended")
            data += received
        return data

    def _ask(self, function, first, value):
        """Sends a request. Returns the data of the reply.

        Raises ValueError if the reply is an exception, or if its header, unit or function is wrong.
        """
        request = struct.pack(">BBHH", 1, function, first, value)
        self._transaction += 1
        self._socket.sendall(struct.pack(">HHH", self._transaction, 0, len(request)) + request)
        header = self._receive(6)
        transaction, protocol, length = struct.unpack(">HHH", header)
        if (transaction, protocol) != (self._transaction, 0):
            raise ValueError(f"wrong header: {header.hex(' ')}")
        reply = self._receive(length)
        if reply[:2] != request[:2]:
            expected = f"expected a reply that begins with {request[:2].hex(' ')}, in hex"
            raise ValueError(f"request {request.hex(' ')}: wrong reply {reply.hex(' ')}; {expected}")
        return reply[2:]

    def read(self, kind, first, count=1):
        """Returns bits or registers as numbers. Raises ValueError like `_ask`."""
        data = self._ask(FUNCTION_OF_READING[kind], first, count)[1:]
        if kind in ["coil", "discrete_input"]:
            return [data[bit // 8] >> bit % 8 & 1 for bit in range(count)]
        return list(struct.unpack(f">{count}H", data))

    def write_coil(self, address, on):
        """Writes a coil. Raises ValueError like `_ask`, and if the reply has another coil address or value."""
        value = 0xFF00 if on else 0x0000
        reply = self._ask(5, address, value)
        if reply != struct.pack(">HH", address, value):
            expected = "expected the coil address and the value, in hex"
            raise ValueError(f"write of {value:04X} to coil {address:04X}: wrong reply {reply.hex(' ')}; {expected}")
