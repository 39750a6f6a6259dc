"""A simulated module, and a master that sends requests as the tools do."""

import re
import socket
import struct
import subprocess

from program import PROGRAM

FUNCTION_OF_READING = {"coil": 1, "discrete_input": 2, "holding": 3, "input": 4}


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return struct.pack("<H", crc)


class Line:
    """One module at address 01, which a master reaches over TCP with Modbus RTU frames."""

    def __init__(self, model):
        command = [PROGRAM, f"{model}@01", "--tcp", "0", "--line", "instant"]
        self._program = subprocess.Popen(command, stdout=subprocess.PIPE, encoding="utf-8")
        greeting = "".join(iter(self._program.stdout.readline, "press Ctrl-C to end\n"))
        port = int(re.search(r"TCP 127\.0\.0\.1:(\d+)", greeting).group(1))
        self._socket = socket.create_connection(("127.0.0.1", port), timeout=60)  # seconds; only detects a hang

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
        """Returns the data of the reply, without address, function and CRC. Raises ValueError for an exception."""
        request = struct.pack(">BBHH", 1, function, first, value)
        self._socket.sendall(request + crc16(request))
        reply = self._receive(3)
        if reply[1] & 0x80:
            self._receive(2)
            raise ValueError(f"exception {reply[2]:02} to {request.hex(' ')}")
        reply += self._receive(5 if function >= 5 else reply[2] + 2)
        if crc16(reply[:-2]) != reply[-2:]:
            raise ValueError(f"wrong CRC: {reply.hex(' ')}")
        return reply[2:-2]

    def read(self, kind, first, count=1):
        """Returns bits or registers as numbers. Raises ValueError if the reply is an exception."""
        data = self._ask(FUNCTION_OF_READING[kind], first, count)[1:]
        if kind in ["coil", "discrete_input"]:
            return [data[bit // 8] >> bit % 8 & 1 for bit in range(count)]
        return list(struct.unpack(f">{count}H", data))

    def write_coil(self, address, on):
        """Writes a coil. Raises ValueError if the reply is an exception."""
        self._ask(5, address, 0xFF00 if on else 0x0000)
