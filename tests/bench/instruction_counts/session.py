"""One image, one protocol: asks everything and returns what was counted."""

import socket
import threading
import time

from instruction_counts import execution
from instruction_counts.counter import Counter
from instruction_counts.emulator import Emulator
from instruction_counts.image import Image
from instruction_counts.requests import DONE, IGNORED, ascii_requests, crc16, dcon, modbus_requests, rtu

INIT = "A7"  # boards/lm3s6965evb/board.hpp
INPUTS = ["B0", "B1", "B4", "B5", "B6", "C4", "C5", "C6"]

START_UP = 20  # seconds
DEBOUNCE = 0.03
PATIENCE = 0.15  # for a reply
DRIVER_OFF = 0.0006  # behind a reply, at 115200 baud
DRIVER_OFF_AT_9600 = 0.01
BYTES_TAKEN = 0.02
TICKS = 0.2
BEHIND_A_TICK = 0.0002  # its turn is over
TRIES = 10  # of a pass
DEAF = 30  # passes in a row that have not even begun
BYTE_BY_BYTE = 10  # one pass in so many has the interrupts of all its bytes counted


class Session:
    """ASCII is spoken with checksums, which cost more."""

    def __init__(self, image, model, is_ascii):
        self.image = Image(image)
        self._model = model
        self._ascii = is_ascii
        of_the_tick = self.image.addresses_of("look_around")
        if not of_the_tick:
            raise RuntimeError(f"{image}: no code of `look_around`, which the main loop does for the tick")
        behind_a_gap = self.image.addresses_of("behind_a_gap")
        if not behind_a_gap and not is_ascii:
            raise RuntimeError(f"{image}: no code of `behind_a_gap`, where a byte ends the frame before it")
        sleeps = self.image.sleeps()
        self.counter = Counter(self.image.handlers(), sleeps, of_the_tick, behind_a_gap, is_ascii)
        self._emulator = Emulator(image)
        threading.Thread(
            target=execution.follow, args=(self._emulator.log, sleeps, self.counter), daemon=True
        ).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._emulator.close()

    def count_requests(self, general, wanted, passes):
        """`general`: what all models have, too; `wanted` says of a request whether it is to be asked; `passes`
        limits how often."""
        requests = (
            ascii_requests(self._model, general, True)
            if self._ascii
            else modbus_requests(self._model, general)
        )
        for request in filter(wanted, requests):
            if request.init:
                self._set_init(True)
            self._count(request, min(passes, request.passes))
            if request.init:
                self._set_init(False)

    def count_edges(self, passes):
        """Each input alone, then all inputs of a port at once; up and down in turn."""
        ports = sorted({pin[0] for pin in INPUTS})
        together = [[pin for pin in INPUTS if pin[0] == port] for port in ports]
        for pins in [[pin] for pin in INPUTS] + together:
            for attempt in range(passes):
                self._emulator.halt()
                for pin in pins:
                    self._emulator.set_pin(pin, attempt % 2 == 0)
                self.counter.edges_at_once = len(pins)
                self._log(True)
                self.counter.over.clear()
                self._emulator.run()
                self.counter.over.wait(PATIENCE)
                self._log(False)

    def count_ticks(self):
        self.counter.nothing_to_do = True
        self._log(True)
        time.sleep(TICKS)
        self._log(False)
        self.counter.nothing_to_do = False

    def set_up(self):
        """Once, before all else. Address 01, 115200 baud, the checksum where it is ASCII; by INIT*, as people do it."""
        for pin in INPUTS:
            self._emulator.set_pin(pin, False)
        self._emulator.set_pin(INIT, False)
        self._emulator.run()
        self._wake_up(dcon("$00M", False), b"\r")
        commands = [f"%0001400A{'40' if self._ascii else '00'}"]
        if self._model.modbus:
            commands.append(f"$00P{0 if self._ascii else 1}")
        for command in commands:
            time.sleep(DRIVER_OFF_AT_9600)
            self._emulator.line.sendall(dcon(command, False))
            if not self._hear(b"\r", 2).startswith(b"!"):
                raise RuntimeError(f"{self._model.name} does not take {command}")
        self._emulator.halt()
        self._emulator.reset()
        self._emulator.set_pin(INIT, True)
        self._emulator.run()
        self._wake_up(self._question())
        self.counter.forget()

    def _count(self, request, passes):
        """As the last of its frames leaves the module, so it was before."""
        self.counter.expect(request)
        highest = self.counter.requests[request]
        highest.wanted = passes
        begun, lost = None, 0
        for attempt in range(TRIES * passes):
            begun_before, begun = begun, highest.passes + self.counter.spoiled
            lost = lost + 1 if begun == begun_before else 0
            if highest.passes >= passes or lost > DEAF:
                break
            in_turn = len(request.before) == len(request.frames) > 1
            for frame in [request.before[attempt % len(request.before)]] if in_turn else request.before:
                self._say(frame)
            time.sleep(request.settles)
            self._pass(
                request, request.frames[attempt % len(request.frames)], attempt < passes / BYTE_BY_BYTE
            )
        if len(request.frames) > 1:
            self._say(request.frames[-1])
            if not self._is_there():
                self._say(request.frames[-1])
                if not self._is_there():
                    raise RuntimeError(f"{self._model.name} is deaf behind {request.name}")

    def _pass(self, request, frame, byte_by_byte):
        self.counter.over.clear()
        if byte_by_byte:
            self._log(True)
            for byte in frame[:-1]:
                self._send(bytes([byte]))
            self._send_last(frame[-1:])
        elif self._ascii:
            self._send(frame[:-1])
            self._log(True)
            self._send_last(frame[-1:])
        else:
            self._emulator.line.sendall(frame)
            self._log(True)  # well within the silence
        self.counter.over.wait(PATIENCE)
        self._log(False)
        if request.until not in (DONE, IGNORED):
            self._hear()

    def _send(self, some):
        """Returns when the image has taken these bytes, so that the next has an interrupt of its own."""
        expected = self.counter.bytes_taken + len(some)
        self._emulator.line.sendall(some)
        gives_up = time.monotonic() + BYTES_TAKEN
        while self.counter.bytes_taken < expected and time.monotonic() < gives_up:
            time.sleep(0.00003)

    def _send_last(self, byte):
        """In ASCII a pass begins with this byte, so it comes where the next tick is far."""
        if self._ascii:
            self.counter.ticked.clear()
            self.counter.ticked.wait(PATIENCE)
            time.sleep(BEHIND_A_TICK)
        self._emulator.line.sendall(byte)

    def _say(self, frame):
        """A frame whose answer is not counted; broadcasts have none."""
        self._emulator.line.sendall(frame)
        if frame[1:3] == b"**":
            time.sleep(0.003)
        else:
            self._hear()

    def _wake_up(self, question, end=None):
        """Asks until there is an answer, and lets all answers come."""
        gives_up = time.monotonic() + START_UP
        while True:
            self._emulator.line.sendall(question)
            if self._hear(end):
                break
            if time.monotonic() > gives_up:
                raise RuntimeError(f"{self._model.name} does not answer")
        while self._hear(end):
            pass

    def _question(self):
        return dcon("$01M", True) if self._ascii else rtu("01 46 00")

    def _is_there(self):
        for _ in range(5):
            self._emulator.line.sendall(self._question())
            if self._hear():
                return True
        return False

    def _hear(self, end=None, patience=PATIENCE):
        """A reply, whole if it ends with `end` or as the protocol has it; nothing where none comes."""
        reply = b""
        self._emulator.line.settimeout(patience)
        try:
            while not (reply.endswith(end) if end else self._is_whole(reply)):
                reply += self._emulator.line.recv(256)
        except socket.timeout:
            pass
        time.sleep(DRIVER_OFF)
        return reply

    def _is_whole(self, reply):
        if self._ascii:
            return reply.endswith(b"\r")
        return len(reply) >= 4 and crc16(reply[:-2]) == reply[-2:]

    def _set_init(self, asserted):
        self._emulator.set_pin(INIT, not asserted)
        time.sleep(DEBOUNCE)

    def _log(self, on):
        if on:
            self._emulator.mark()
        self._emulator.log_instructions(on)
