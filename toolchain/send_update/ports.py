"""Ports: bytes to and from a line, through a serial port or a TCP connection."""

from __future__ import annotations

import os
import select
import socket
import time
from typing import Callable

FORMATS = ("8N1", "8N2", "8E1", "8O1")
_CONNECT = 5  # seconds
_CHUNK = 4096


class PortError(Exception):
    """The port cannot be opened, or it is gone."""


class Port:
    def __init__(self, file, read: Callable[[int], bytes], write: Callable[[bytes], object]) -> None:
        self._file = file
        self._read = read
        self._write = write

    def receive(self, seconds: float) -> bytes:
        """Returns what has come, as soon as there is something, or nothing after this time. Raises PortError."""
        try:
            if not select.select([self._file], [], [], max(seconds, 0))[0]:
                return b""
            if data := self._read(_CHUNK):
                return data
        except OSError as error:
            raise PortError(f"{error}; connect it again") from error
        raise PortError("the other side has closed the connection; start it again")

    def send(self, data: bytes) -> None:
        """Raises PortError."""
        try:
            self._write(data)
        except OSError as error:
            raise PortError(f"{error}; connect it again") from error

    @staticmethod
    def pause(seconds: float) -> None:
        time.sleep(seconds)

    def close(self) -> None:
        self._file.close()


def serial_port(path: str, baud: int, line_format: str) -> Port:
    """Raises PortError."""
    try:
        from serial import Serial  # pylint: disable=import-outside-toplevel # TCP does not require it
    except ImportError as error:
        raise PortError("python3-serial is missing; run toolchain/install-packages python3-serial") from error
    try:
        # timeout=0: `receive` waits. To set the timeout later would set up the whole port again.
        port = Serial(path, baud, parity=line_format[1], stopbits=int(line_format[2]), timeout=0, exclusive=True)
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else error
        raise PortError(f"{reason}; name a serial port that is there and not in use") from error
    return Port(port, port.read, port.write)


def tcp_port(host: str, number: int) -> Port:
    """Raises PortError."""
    try:
        connection = socket.create_connection((host, number), timeout=_CONNECT)
    except (OSError, OverflowError) as error:
        raise PortError(f"{error}; name a host and a port that accept connections") from error
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return Port(connection, connection.recv, connection.sendall)
