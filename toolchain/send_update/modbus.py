"""Modbus: requests to a module, as RTU frames or in Modbus TCP."""

from __future__ import annotations

import struct
import time
from dataclasses import dataclass

from send_update.ports import Port

_EXCEPTION = 0x80
_NO_REPLY_TO_GATEWAY = 0x0B
_BY_SERIAL_NUMBER, _REPLY_BY_SERIAL_NUMBER = b"\xfd\x46\x08", b"\xfd\x46\x09"
_EXCEPTIONS = {1: "illegal function", 2: "illegal data address", 3: "illegal data value", 4: "server device failure",
               0x0A: "gateway path unavailable"}


class NoReply(Exception):
    pass


class Refused(Exception):
    def __init__(self, code: int) -> None:
        super().__init__(f"exception {code:02X} ({_EXCEPTIONS.get(code, 'unknown')})")
        self.code = code


@dataclass(frozen=True)
class Target:
    """What precedes a PDU in a request and in a reply: the address, or function 46 (hex) with a serial number."""

    name: str
    request: bytes
    reply: bytes

    @property
    def has_address(self) -> bool:
        return len(self.request) == 1


def target(text: str) -> Target:
    """Returns the module with an address or a serial number. Raises ValueError if `text` is neither."""
    if text.isdecimal() and len(text) <= 3 and 1 <= int(text) <= 247:
        address = bytes([int(text)])
        return Target(str(int(text)), address, address)
    serial_number = bytes.fromhex(text)
    if len(text) != 8 or len(serial_number) != 4:
        raise ValueError
    return Target(text.upper(), _BY_SERIAL_NUMBER + serial_number, _REPLY_BY_SERIAL_NUMBER + serial_number)


@dataclass(frozen=True)
class Request:
    """The PDU of a request, and how that of its reply begins, and the length of this one."""

    pdu: bytes
    reply: bytes
    reply_length: int


def read(address: int, count: int) -> Request:
    return Request(struct.pack(">BHH", 3, address, count), bytes([3, 2 * count]), 2 + 2 * count)


def write(address: int, value: int) -> Request:
    pdu = struct.pack(">BHH", 6, address, value)
    return Request(pdu, pdu, 5)


def write_block(address: int, data: bytes) -> Request:
    begin = struct.pack(">BHH", 0x10, address, len(data) // 2)
    return Request(begin + bytes([len(data)]) + data, begin, 5)


def crc16(data: bytes) -> int:
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return crc


class Rtu:
    """RTU frames on a port."""

    # A line that is never silent must not keep `exchange` for ever.
    _MOST_READINGS = 100
    _MOST_BYTES = 1000

    def __init__(self, port: Port, baud: int) -> None:
        self.port = port
        self._character = 11 / baud  # seconds
        self._silence = max(3.5 * self._character, 0.00175)

    def exchange(self, to: Target, request: Request, seconds: float) -> bytes:
        """Returns the PDU of the reply. `seconds`: of the module, without the frames. Raises NoReply."""
        for _ in range(self._MOST_READINGS):
            if not self.port.receive(self._silence):
                break
        frame = to.request + request.pdu
        frame += crc16(frame).to_bytes(2, "little")
        self.port.send(frame)
        length = len(to.reply) + request.reply_length + 2
        until = time.monotonic() + seconds + self._character * (len(frame) + length)
        exception = bytes([request.pdu[0] | _EXCEPTION])
        received = b""
        while len(received) < self._MOST_BYTES and (more := self.port.receive(until - time.monotonic())):
            received += more
            for begin, size in ((request.reply, length), (exception, len(to.reply) + 4)):
                if reply := _frame_in(received, to.reply + begin, size):
                    return reply[len(to.reply) :]
        raise NoReply


def _frame_in(received: bytes, begin: bytes, length: int) -> bytes:
    """Returns the frame that begins so, without CRC: noise or the echo of the request may precede it."""
    at = received.find(begin)
    while at >= 0:
        frame = received[at : at + length]
        if len(frame) == length and crc16(frame) == 0:
            return frame[:-2]
        at = received.find(begin, at + 1)
    return b""


class ModbusTcp:
    """Modbus TCP. The unit is the address of the module."""

    _HEADER = struct.Struct(">HHHB")  # transaction, protocol, bytes that follow, unit
    _LINE_SECONDS = 2  # for the frames on the line behind a gateway, whatever its rate

    def __init__(self, port: Port) -> None:
        self.port = port
        self._transaction = 0
        self._received = b""

    def exchange(self, to: Target, request: Request, seconds: float) -> bytes:
        """Returns the PDU of the reply. Raises NoReply."""
        self._transaction = (self._transaction + 1) & 0xFFFF
        self.port.send(self._HEADER.pack(self._transaction, 0, 1 + len(request.pdu), to.request[0]) + request.pdu)
        until = time.monotonic() + seconds + self._LINE_SECONDS
        while more := self.port.receive(until - time.monotonic()):
            self._received += more
            while len(self._received) >= self._HEADER.size:
                transaction, _, length, _ = self._HEADER.unpack_from(self._received)
                frame, rest = self._received[: 6 + length], self._received[6 + length :]
                if len(frame) < 6 + length:
                    break
                self._received = rest
                pdu = frame[self._HEADER.size :]
                if transaction == self._transaction and _answers(pdu, request):
                    return pdu
        raise NoReply


def _answers(pdu: bytes, request: Request) -> bool:
    if pdu[:1] == bytes([request.pdu[0] | _EXCEPTION]):
        return len(pdu) == 2
    return pdu.startswith(request.reply) and len(pdu) == request.reply_length


@dataclass(frozen=True)
class Module:
    transport: Rtu | ModbusTcp
    target: Target

    def ask(self, request: Request, seconds: float) -> bytes:
        """Returns the data of a reply: what follows its known beginning. Raises NoReply or Refused."""
        pdu = self.transport.exchange(self.target, request, seconds)
        if not pdu[0] & _EXCEPTION:
            return pdu[len(request.reply) :]
        if pdu[1] == _NO_REPLY_TO_GATEWAY:
            raise NoReply
        raise Refused(pdu[1])

    def pause(self, seconds: float) -> None:
        self.transport.port.pause(seconds)
