"""Sends requests to one image in one protocol, changes the inputs of the image, and counts the instructions."""

import threading

from instruction_counts import execution
from instruction_counts.counter import Counter
from instruction_counts.emulator import HANG, Emulator
from instruction_counts.image import Image
from instruction_counts.requests import DONE, IGNORED, ascii_requests, crc16, dcon, modbus_requests, rtu

# The pin of INIT*, and the pins of the inputs. One interrupt serves all pins of a group.
INIT = "A7"
INPUTS = [["B0", "B1", "B4", "B5", "B6"], ["C4", "C5", "C6"]]

# All these times are in seconds of emulated time.
START_UP = 0.1  # until the module has nothing to do
DEBOUNCE = 0.03
PATIENCE = 0.25  # maximum time until a reply is complete
DRIVER_OFF = 0.0006  # maximum time from a reply until the driver enable is off, at 115200 baud
DRIVER_OFF_AT_9600 = 0.01
BYTE = 10 / 115200
BYTE_AT_9600 = 10 / 9600
SLICE = 0.001
PASS = 0.3  # maximum time from the end of a request to the end of its pass
REST = 0.2

QUIET = 0.004  # after this time, the module has processed a request that has no reply


class Session:
    """Sends requests to one image. ASCII sessions use checksums, because requests with checksums require more
    instructions."""

    def __init__(self, image, gate, model, is_ascii):
        self.image = Image(image)
        self._model = model
        self._ascii = is_ascii
        self._sleeps = self.image.sleeps()
        self.counter = Counter(self.image.handlers(), self._sleeps)
        self._emulator = Emulator(image, gate)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._emulator.close()

    def count_requests(self, general, wanted, passes):
        """Counts the instructions of requests. With `general`, also sends the requests that are the same for all
        models. `wanted` is a function that returns whether to send a request. `passes` is the maximum number of passes
        of each request."""
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
        """Counts the instructions of edges. First sets a filter for the first channel, because with a filter, the
        interrupt of an edge of any channel also reads the clock and wakes the main loop. Changes each input alone
        `passes` times, then all inputs of each group together `passes` times. The levels alternate between high and
        low."""
        self._set_filter(1)
        for pins in [[pin] for group in INPUTS for pin in group] + INPUTS:
            for attempt in range(passes):
                self._log(True)
                for pin in pins:
                    self._emulator.set_pin(pin, attempt % 2 == 0)
                self.counter.edges_at_once = len(pins)
                self._run(SLICE)
                self._log(False)
                self._let_counter_catch_up()
        self._set_filter(0)

    def count_rest(self):
        self._let_counter_catch_up()
        self.counter.nothing_happens = True
        self._log(True)
        self._run(REST)
        self._log(False)
        self._let_counter_catch_up()
        self.counter.nothing_happens = False

    def set_up(self):
        """Configures the module in INIT mode, as a user does: the protocol, address 01, 115200 baud, and checksums for
        ASCII. Call this function once, before all others."""
        self._power_up(False)
        commands = [f"%0001400A{'40' if self._ascii else '00'}"]
        if self._model.modbus:
            commands.append(f"$00P{0 if self._ascii else 1}")
        for command in commands:
            self._say(dcon(command, False), BYTE_AT_9600)
            if not self._hear(b"\r").startswith(b"!"):
                raise RuntimeError(f"{self._model.name}: no valid reply to {command}; expected a reply with !")
            self._run(DRIVER_OFF_AT_9600)
        self._emulator.power_down()
        self._power_up(True)
        if not self._is_there():
            raise RuntimeError(f"{self._model.name}: no reply after the set-up; expected a reply from address 01")
        self.counter.forget()

    def _power_up(self, init):
        """Switches the supply on. `init` is the level of INIT*."""
        inputs = [pin for group in INPUTS for pin in group]
        self._emulator.power_up({**dict.fromkeys(inputs, False), INIT: init})
        threading.Thread(
            target=execution.follow, args=(self._emulator.log, self._sleeps, self.counter), daemon=True
        ).start()
        self._run(SLICE)
        self._run(START_UP)

    def _count(self, request, passes):
        """Repeats a request. If the request has several frames, sends the last frame once more at the end, so that the
        module has the address and the line settings of the session, and checks that the module replies."""
        for attempt in range(passes):
            in_turn = len(request.before) == len(request.frames) > 1
            for frame in [request.before[attempt % len(request.before)]] if in_turn else request.before:
                self._converse(frame)
            if request.settles:
                self._run(request.settles)
            self._pass(request, request.frames[attempt % len(request.frames)])
        if len(request.frames) > 1:
            self._converse(request.frames[-1])
            if not self._is_there():
                raise RuntimeError(
                    f"{self._model.name}: no reply after {request.name}; expected a reply at its own address"
                )

    def _pass(self, request, frame):
        self._log(True)
        self._let_counter_catch_up()  # events of the previous request must not count for this one
        self.counter.begin()
        self._say(frame)
        is_answered = request.until not in (DONE, IGNORED)
        if not is_answered:
            self._run(QUIET)
        self._run_until(lambda: self.counter.at_rest and self.counter.answered == is_answered, request.name)
        self.counter.end(request)
        self._log(False)
        if is_answered:
            self._hear()
        self._run(DRIVER_OFF)

    def _run_until(self, is_over, name):
        for _ in range(round(PASS / SLICE)):
            self._run(SLICE)
            self._let_counter_catch_up()
            if is_over():
                return
        raise RuntimeError(f"{self._model.name}: {name} does not end; expected its end within {PASS} s")

    def _let_counter_catch_up(self):
        """Waits until the counter has read the log up to now. The emulator does not run during this time."""
        self._emulator.write_sync_line()
        self.counter.wait_until_seen(HANG)

    def _run(self, seconds):
        self._emulator.run_for(seconds)

    def _say(self, frame, byte_takes=BYTE):
        for byte in frame:
            self._emulator.put(byte)
            self._run(byte_takes)

    def _converse(self, frame):
        """Sends a frame that is not counted, and waits for its reply. The broadcasts of DCON have no reply."""
        self._say(frame)
        if frame[1:3] == b"**":
            self._run(0.003)
        else:
            self._hear()

    def _is_there(self):
        self._say(dcon("$01M", True) if self._ascii else rtu("01 46 00"))
        return self._hear() != b""

    def _hear(self, end=None):
        """Waits for a reply and returns it. The reply is complete when it ends with `end`. If `end` is None, the reply
        is complete when it ends with a CR in ASCII, or with a correct CRC in Modbus. If the reply is not complete
        after PATIENCE, returns the bytes that have arrived, possibly none."""
        reply = self._emulator.said()
        left = PATIENCE
        while not (reply.endswith(end) if end else self._is_whole(reply)) and left > 0:
            self._run(SLICE)
            left -= SLICE
            reply += self._emulator.said()
        self._run(DRIVER_OFF)
        return reply

    def _is_whole(self, reply):
        if self._ascii:
            return reply.endswith(b"\r")
        return len(reply) >= 4 and crc16(reply[:-2]) == reply[-2:]

    def _set_filter(self, milliseconds):
        value = f"{milliseconds:04X}"
        self._converse(dcon(f"~01X0240{value}", True) if self._ascii else rtu(f"01 06 0240 {value}"))

    def _set_init(self, asserted):
        self._emulator.set_pin(INIT, not asserted)
        self._run(DEBOUNCE)

    def _log(self, on):
        if on:
            self._emulator.mark()
        self._emulator.log_instructions(on)
