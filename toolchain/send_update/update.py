"""The update of one module, step by step."""

from __future__ import annotations

import dataclasses
import enum
import struct
from typing import Callable

import update_file
from send_update import modbus
from send_update.modbus import Module, NoReply, Refused, Request

_SIGNATURE, _SIGNATURE_SIZE = 0x0122, 12
_UPDATES_ALLOWED = 0x0254
_VERSION = 0x0300
_BEGIN = 0x1000
_STATE = 0x1010  # then the next offset, high word first
_CONTROL, _ACTIVATE = 0x1013, 1
_BLOCK = 0x2000

_BAD_VALUE, _FAILED, _BUSY = 3, 4, 6  # exceptions

_SECONDS = 1  # for a reply
_BEGIN_SECONDS = 5
_REPEATS = 3  # of a request without reply, and of an update that the module has forgotten
_BLOCK_REPEATS = 40  # of a block that is refused because the flash still works; a refusal can come at once
_READY_POLLS, _READY_PAUSE = 50, 0.2
_CONFIRMED_POLLS, _CONFIRMED_PAUSE = 90, 1


class State(enum.IntEnum):
    NONE = 0
    RECEIVING = 1
    COMPLETE = 2
    ACTIVATION_PENDING = 3
    UNCONFIRMED = 4
    TAKEN_BACK = 5
    FLASH_FAILED = 6


class Failed(Exception):
    """The update of this module has failed. The text says why, and what to do."""


class Update:
    """The steps, in this order: `prepare`, `send`, `activate`, `wait_until_it_runs`, `wait_until_confirmed`. They
    raise Failed, or PortError."""

    def __init__(self, module: Module, file: update_file.Update) -> None:
        self.module = module
        # The module activates only on request, so that several modules can do so together.
        self._info = dataclasses.replace(file.info, flags=0)
        self._blocks = file.blocks
        self.version = update_file.version_text(file.info.version)

    def prepare(self) -> None:
        """Fails if the module cannot get this update. Changes nothing."""
        signature = "".join(chr(word & 0xFF) for word in self._read(_SIGNATURE, _SIGNATURE_SIZE)).rstrip("\0")
        if signature != self._info.signature:
            raise Failed(f"has the signature '{signature}'; the file is for '{self._info.signature}', an"
                         f" {self._info.model} on the board {self._info.board}")
        if self._progress()[0] in (State.ACTIVATION_PENDING, State.UNCONFIRMED):
            raise Failed("still tries an image; start again in a minute, when it has confirmed that one")

    def send(self, show: Callable[[int, int], None]) -> None:
        """Sends what the module does not have yet. Tells `show` how many bytes it has, and the length."""
        for _ in range(1 + _REPEATS):
            self._begin()
            if self._send_blocks(show):
                break
        else:
            raise Failed("refuses its blocks; restart it, and start again")
        if self._state_after(State.RECEIVING) != State.COMPLETE:
            raise Failed("has all blocks, but not a complete image; start again")
        show(self._info.length, self._info.length)

    def activate(self) -> None:
        try:
            self.module.ask(modbus.write(_CONTROL, _ACTIVATE), _SECONDS)
        except NoReply:
            pass  # If the request was lost, and not its reply, wait_until_it_runs repeats it.
        except Refused as error:
            raise Failed(f"refuses to activate the image: {error}; start again") from error

    def wait_until_it_runs(self) -> None:
        for _ in range(1 + _REPEATS):
            state = self._state_after(State.ACTIVATION_PENDING)
            if state != State.COMPLETE:
                break
            self.activate()
        version = self._version()
        self._fail_if_taken_back(state, version)
        if state not in (State.UNCONFIRMED, State.NONE) or version != self.version:
            raise Failed(f"runs {version} and not {self.version}, in the state {_text(state)}; start again")

    def wait_until_confirmed(self) -> None:
        state = self._state_after(State.UNCONFIRMED, _CONFIRMED_POLLS, _CONFIRMED_PAUSE)
        version = self._version()
        self._fail_if_taken_back(state, version)
        if state != State.NONE or version != self.version:
            raise Failed(f"has not confirmed the image: it runs {version}, in the state {_text(state)}")

    def _begin(self) -> None:
        try:
            self._ask(modbus.write_block(_BEGIN, self._info.packed()), _BEGIN_SECONDS)
        except Refused as error:
            if error.code == _FAILED and self._read(_UPDATES_ALLOWED, 1) == [0]:
                raise Failed("permits no updates; write 1 to register 0x0254 while INIT* is active") from error
            raise Failed(f"refuses the update: {error}") from error

    def _send_blocks(self, show: Callable[[int, int], None]) -> bool:
        """Returns false if the module has forgotten that the update has begun, as it does at a reset."""
        _, next_offset = self._progress()
        for offset in range(next_offset, self._info.length, update_file.DATA_SIZE):
            show(offset, self._info.length)
            try:
                self._send_block(self._blocks[offset // update_file.DATA_SIZE])
            except Refused as error:
                if error.code != _BAD_VALUE:
                    raise Failed(f"refuses the block at {offset}: {error}; start again") from error
                return False
        return True

    def _send_block(self, block: bytes) -> None:
        for _ in range(_BLOCK_REPEATS):
            try:
                self._ask(modbus.write_block(_BLOCK, block))
                return
            except Refused as error:
                if error.code not in (_FAILED, _BUSY):
                    raise
            if self._progress()[0] not in (State.RECEIVING, State.COMPLETE):
                break
        state = self._progress()[0]
        raise Failed(f"has not stored the block, and is in the state {_text(state)}; start again, and replace the board"
                     " if that does not help")

    def _version(self) -> str:
        return update_file.version_text(self._read(_VERSION, 1)[0])

    def _progress(self) -> tuple[int, int]:
        """Returns the state and the next offset."""
        state, high, low = self._read(_STATE, 3)
        return state, high << 16 | low

    def _state_after(self, passing: State, polls: int = _READY_POLLS, pause: float = _READY_PAUSE) -> int:
        """Returns the state as soon as it is not `passing`. No reply may mean that the module starts."""
        state: int = passing
        answered = False
        for _ in range(polls):
            self.module.pause(pause)
            try:
                state = _words(self.module.ask(modbus.read(_STATE, 1), _SECONDS))[0]
            except (NoReply, Refused):
                continue
            answered = True
            if state != passing:
                return state
        if not answered:
            raise Failed("gives no reply any more; start again when it answers")
        return state

    @staticmethod
    def _fail_if_taken_back(state: int, version: str) -> None:
        if state == State.TAKEN_BACK:
            raise Failed(f"has taken the image back and runs {version}: it did not prove itself")

    def _read(self, address: int, count: int) -> list[int]:
        try:
            return _words(self._ask(modbus.read(address, count)))
        except Refused as error:
            raise Failed(f"refuses to read the register {address:#06x}: {error}; its firmware or its board permits no"
                         " update over the line") from error

    def _ask(self, request: Request, seconds: float = _SECONDS) -> bytes:
        for _ in range(1 + _REPEATS):
            try:
                return self.module.ask(request, seconds)
            except NoReply:
                pass
        raise Failed("gives no reply; check address, rate, format, protocol (Modbus) and wires")


def _words(data: bytes) -> list[int]:
    return list(struct.unpack(f">{len(data) // 2}H", data))


def _text(state: int) -> str:
    return f"{state} ({State(state).name.lower().replace('_', ' ')})" if state in list(State) else str(state)
