"""A module with image slots as send-update sees it, and a port with such modules. No time passes here but that of
`pause` and of vain waiting, at once."""

from __future__ import annotations

import struct
from typing import Callable
from zlib import crc32

# How send-update addresses a request by serial number, and how the module replies.
BY_SERIAL_NUMBER, REPLY_BY_SERIAL_NUMBER = b"\xfd\x46\x08", b"\xfd\x46\x09"

NONE, RECEIVING, COMPLETE, PENDING, UNCONFIRMED, TAKEN_BACK, FLASH_FAILED = range(7)


def with_crc(data: bytes) -> bytes:
    """Returns an RTU frame: the CRC of the Modbus specification, by division of polynomials."""
    register = 0xFFFF
    for bit in (byte >> place & 1 for byte in data for place in range(8)):
        register = register >> 1 ^ 0xA001 if (register ^ bit) & 1 else register >> 1
    return data + struct.pack("<H", register)


class Refusal(Exception):
    def __init__(self, code: int) -> None:
        super().__init__()
        self.code = code


class FakeModule:
    def __init__(
        self, address: int = 5, serial_number: bytes = b"\x0d\x00\x1f\x3a", signature: str = "9042DM.pico"
    ) -> None:
        self.reset_lasts = 0.5  # seconds without reply after an activation
        self.address = address
        self.serial_number = serial_number
        self.signature = signature
        self.version = 0x0100
        self.state = NONE
        self.info = b""
        self.image = b""  # received up to here
        self.begins: list[bytes] = []
        self.blocks: list[int] = []  # their offsets, refused ones too
        self.erasing = 0  # refuses so many blocks because it still erases
        self.flash_fails_at = -1
        self.takes_back = False
        self.confirms = True
        self.allowed = True
        self.has_slots = True
        self._since_activation: float | None = None

    def pass_time(self, seconds: float) -> None:
        if self._since_activation is None:
            return
        self._since_activation += seconds
        if self.state == PENDING and self._since_activation >= self.reset_lasts:
            self.state = TAKEN_BACK if self.takes_back else UNCONFIRMED
            if not self.takes_back:
                self.version = struct.unpack_from(">H", self.info, 16)[0]
        if self.state == UNCONFIRMED and self._since_activation >= 60 and self.confirms:
            self.state = NONE

    def reset(self) -> None:
        """A power cycle while it receives: whole sectors stay."""
        self.image = self.image[: len(self.image) // 4096 * 4096]
        if not self.image:
            self.state = NONE

    def reply(self, pdu: bytes) -> bytes:
        """Returns the PDU of the reply, or nothing if there is none."""
        if self.state == PENDING:
            return b""
        try:
            return self._answer(pdu)
        except Refusal as refusal:
            return bytes([pdu[0] | 0x80, refusal.code])

    def _answer(self, pdu: bytes) -> bytes:
        function, address, value = struct.unpack_from(">BHH", pdu)
        if function == 3:
            words = [self._register(number) for number in range(address, address + value)]
            return struct.pack(f">BB{value}H", 3, 2 * value, *words)
        if function == 6 and (address, value) == (0x1013, 1):
            if self.state != COMPLETE:
                raise Refusal(4)
            self.state, self._since_activation = PENDING, 0
            return pdu
        data = pdu[6:]
        assert function == 0x10 and pdu[5] == len(data) == 2 * value
        if (address, value) == (0x1000, 16):
            self._begin(data)
        elif (address, value) == (0x2000, 68):
            self._block(*struct.unpack(">I128sI", data))
        else:
            raise Refusal(2)
        return pdu[:5]

    def _register(self, number: int) -> int:
        if 0x0122 <= number < 0x0122 + 12:
            return self.signature.encode().ljust(12, b"\0")[number - 0x0122]
        registers = {0x0300: self.version}
        if self.has_slots:
            next_offset = min(len(self.image), self._length())
            registers |= {0x0254: int(self.allowed), 0x1010: self.state, 0x1011: next_offset >> 16,
                          0x1012: next_offset & 0xFFFF}
        if number not in registers:
            raise Refusal(2)
        return registers[number]

    def _begin(self, info: bytes) -> None:
        self.begins.append(info)
        if not self.allowed or info[:12].rstrip(b"\0") != self.signature.encode():
            raise Refusal(4)
        if info != self.info or self.state not in (RECEIVING, COMPLETE):
            self.image = b""
            self.info = info
            self.state = RECEIVING

    def _length(self) -> int:
        return int.from_bytes(self.info[12:16], "big")

    def _block(self, offset: int, data: bytes, check: int) -> None:
        self.blocks.append(offset)
        good = check == crc32(struct.pack(">I128s", offset, data)) and offset <= len(self.image)
        if not good or self.state not in (RECEIVING, COMPLETE):
            raise Refusal(3)
        if self.erasing:
            self.erasing -= 1
            raise Refusal(4)
        if offset == self.flash_fails_at:
            self.state = FLASH_FAILED
            raise Refusal(4)
        if offset < len(self.image):
            if self.image[offset : offset + 128] != data:
                raise Refusal(3)
            return
        self.image += data
        if len(self.image) >= self._length():
            if crc32(self.image[: self._length()]) != int.from_bytes(self.info[20:24], "big"):
                self.state, self.image = NONE, b""
                raise Refusal(4)
            self.state = COMPLETE


class FakePort:
    """`fault`: changes a reply, or raises an exception; it gets the request and the reply as frames."""

    def __init__(self, *modules: FakeModule, fault: Callable[[bytes, bytes], bytes] = lambda _, reply: reply) -> None:
        self.modules = modules
        self.fault = fault
        self.sent: list[bytes] = []
        self._received = b""

    def send(self, frame: bytes) -> None:
        assert with_crc(frame[:-2]) == frame
        self.sent.append(frame)
        self._received += self.fault(frame, self.reply(frame))

    def reply(self, frame: bytes) -> bytes:
        for module in self.modules:
            address = bytes([module.address])
            by_serial_number = BY_SERIAL_NUMBER + module.serial_number
            for head, of_reply in (
                (address, address),
                (by_serial_number, REPLY_BY_SERIAL_NUMBER + module.serial_number),
            ):
                if frame.startswith(head) and (pdu := module.reply(frame[len(head) : -2])):
                    return with_crc(of_reply + pdu)
        return b""

    def receive(self, seconds: float) -> bytes:
        received, self._received = self._received, b""
        if not received:
            self.pause(seconds)
        return received

    def pause(self, seconds: float) -> None:
        for module in self.modules:
            module.pass_time(seconds)

    def close(self) -> None:
        pass
