"""From spans of the trace to counts."""

import threading

from instruction_counts import trace
from instruction_counts.requests import REPLY, SILENCE, STORE

IDLE_TURN = 24  # instructions: asked for news, found none, slept


class Highest:
    """The highest of some counts, and the instructions of that one."""

    def __init__(self):
        self.passes = 0
        self.count = 0
        self.addresses = []

    def note(self, addresses, divisor=1):
        self.passes += 1
        if len(addresses) / divisor > self.count:
            self.count = len(addresses) / divisor
            self.addresses = addresses


class Measurer:
    """A listener of trace.read. `ends_with_cr` is ASCII's way to end a frame, else silence is."""

    def __init__(self, ends_with_cr, ticks_own):
        self._ends_with_cr = ends_with_cr
        self._ticks_own = ticks_own  # what the main loop executes for the tick, as in the trace
        self._frame = bytearray()
        self._request = None  # under measurement
        self.lock = threading.Lock()
        self.wanted = {}  # frame: Request
        self.requests = {}  # Request: Highest
        self.forget()

    def forget(self):
        """What was counted until now beside requests, for the module has only just come up."""
        self.byte = Highest()
        self.tick = Highest()
        self.tick_turn = Highest()
        self.idle_turn = Highest()
        self.bytes_together = 0
        self.spoiled = 0

    def want(self, request):
        with self.lock:
            self.wanted = {frame: request for frame in request.frames}
            self.requests.setdefault(request, Highest())

    def entered(self, span, main):
        if span.exception == trace.SILENCE and not self._ends_with_cr:
            self._begin(span, main)

    def left(self, span, main):
        if span.exception == trace.LINE and span.received:
            if len(span.received) > 1:
                self.bytes_together += 1
            elif not span.sent:
                self.byte.note(span.addresses)
            for byte in span.received:
                self._frame.append(byte)
                if self._ends_with_cr and byte == 0x0D:
                    self._begin(span, main)
        elif span.exception == trace.TICK:
            self.tick.note(span.addresses)
        if self._request is not None and span is not self._start:
            if span.exception != trace.TICK or not self._ends_with_cr or not self._turns:
                self._spoil()

    def slept(self, main):
        if not main.interrupts:
            self.idle_turn.note(main.addresses)
        elif all(span.exception == trace.TICK for span in main.interrupts) and self._request is None:
            self.tick_turn.note(main.addresses)
        if self._request is None:
            return
        self._turns.append(self._own(main))
        worked = len(self._turns[-1]) > IDLE_TURN
        if self._request.until == SILENCE and (worked or not self._ends_with_cr):
            self._end([])

    def sent(self, span):
        if self._request is not None and span.exception == trace.MAIN:
            if self._request.until == REPLY:
                self._end(self._own(span))
            else:
                self._request = None  # something else than was asked for

    def stored(self, span):
        if self._request is not None and span.exception == trace.MAIN:
            if self._request.until == STORE:
                self._end(self._own(span))
            else:
                self._request = None

    def _own(self, main):
        """A turn's instructions without the tick's, and from the request's begin on."""
        addresses = main.addresses if main is not self._main else main.addresses[self._main_begin :]
        return [address for address in addresses if address not in self._ticks_own]

    def _begin(self, span, main):
        frame = bytes(self._frame)
        self._frame.clear()
        with self.lock:
            self._request = self.wanted.get(frame)
        self._start = span
        self._main = main
        self._main_begin = len(main.addresses)
        self._turns = []
        if self._request is not None and (
            self._main_begin > 2 or len(main.interrupts) > 1 or len(span.received) > 1
        ):
            self._spoil()

    def _spoil(self):
        self.spoiled += 1
        self._request = None

    def _end(self, last):
        """What came between judging the request and the turn that ends it is idle."""
        request, self._request = self._request, None
        turns = self._turns[:1]
        if len(self._turns) > 1:
            turns.append(max(self._turns[1:], key=len))
        addresses = self._start.addresses + [address for turn in turns for address in turn] + last
        with self.lock:
            self.requests[request].note(addresses)
