"""From what was executed to counts."""

import threading

from instruction_counts import execution
from instruction_counts.requests import DONE, IGNORED, REPLY, STORE

FALLING_ASLEEP = 24  # instructions: a turn of up to so many has only asked for news


class Highest:
    """The pass with the most instructions."""

    def __init__(self):
        self.wanted = 1
        self.passes = 0
        self.addresses = []
        self.ahead = 0  # the most instructions in the silence before

    def note(self, addresses):
        self.passes += 1
        if len(addresses) > len(self.addresses):
            self.addresses = addresses

    @property
    def count(self):
        return len(self.addresses)


class Counter:
    """Listens to execution.follow. One request at a time is `awaited`; one pass counts from

    - the first instruction of the interrupt that ends the silence behind the request, T3.5 or ASCII's
      turn-around; where there is none, of CR's interrupt,
    - with the main loop asleep before it,
    - to what `Request.until` says.

    It has the instructions of that interrupt and of the main loop's turns. It has not those of turns in which
    nothing is done but to wait. A pass into which another interrupt falls does not count, except where there is
    no reply: what such a request changes may wait for the tick, which is left out, and so is what the main loop
    does for it.

    A byte behind a silence that nobody has told of ends the frame before it, which is else the work of the
    silence's interrupt: `late_byte` has those.

    What was done before, while the silence lasted, is told apart: CR's interrupt, and the turn that judges.
    """

    def __init__(self, handlers, sleeps, of_the_tick, behind_a_gap, ends_with_cr):
        self._first = {number: execution.as_logged(address) for number, address in handlers.items()}
        self._awake = {execution.as_logged(address + 2) for address in sleeps}
        self._of_the_tick = {execution.as_logged(address) for address in of_the_tick}
        self._behind_a_gap = {execution.as_logged(address) for address in behind_a_gap}
        self._ends_with_cr = ends_with_cr
        self._frame = bytearray()
        self._request = None  # whose pass is under way
        self._awaited = {}
        self._judging = []  # turns since the last byte
        self.over = False  # a pass, good or not
        self._seen = threading.Event()
        self.requests = {}
        self.spoiled = 0
        self.edges_at_once = 0
        self.bytes_taken = 0
        self.nothing_to_do = False  # the tick's turns are nothing but that
        self.forget()

    def forget(self):
        """Begins to count what is not a request."""
        self.received_byte = Highest()
        self.late_byte = Highest()  # which ends the frame before it
        self.sent_byte = Highest()
        self.interrupts = {}  # others, by the number of the exception
        self.edges = {}  # by how many were served at once
        self.ticks_turn = Highest()
        self.idle_turn = Highest()

    def expect(self, request):
        self.over = False
        self.requests.setdefault(request, Highest())
        self._awaited = {frame: request for frame in request.frames}

    def wait_until_seen(self, patience):
        """What Emulator.ask_for_sight, called before, asked for."""
        if not self._seen.wait(patience):
            raise RuntimeError("the emulator's log has ended")
        self._seen.clear()

    # --- what execution.follow tells ---

    def seen(self):
        self._seen.set()

    def entered(self, span, main):
        if span.exception == execution.SILENCE:
            if self._ends_with_cr:
                self._go_on(span, main)
            else:
                self._begin(span, main)
            self._frame.clear()

    def left(self, span, main):
        if span.addresses[:1] == [self._first.get(span.exception)]:  # logged from its begin on
            self._note_interrupt(span)
        if span.exception == execution.LINE:
            self._judging = []
            self._frame += bytes(span.received)
            self.bytes_taken += len(span.received)
            if self._ends_with_cr and span.received[-1:] == [0x0D]:
                self._begin(span, main)
                self._frame.clear()
        elif span.exception in execution.EDGES:
            self.over = True
        if self._request is not None and span is not self._began:
            if span.exception != execution.TICK or self._request.until != DONE or not self._turns:
                self._spoil()

    def slept(self, main):
        if main.addresses[0] not in self._awake:
            return  # logging began in between
        if main.interrupts == [execution.TICK] and self.nothing_to_do:
            self.ticks_turn.note(main.addresses)
        if len(main.addresses) <= FALLING_ASLEEP:
            self.idle_turn.note(main.addresses)
        if self._request is None:
            self._judging.append(sum(address not in self._of_the_tick for address in main.addresses))
            return
        self._turns.append(self._without_the_ticks(main))
        worked = len(main.addresses) > FALLING_ASLEEP
        acted = worked and (self._silent or not self._request.turn_around)
        if self._request.until == IGNORED or (self._request.until == DONE and acted):
            self._end([])

    def sent(self, span):
        if self._request is not None and span.exception == execution.MAIN:
            if self._request.until == REPLY:
                self._end(self._without_the_ticks(span))
            else:
                self._spoil()

    def stored(self, span):
        if self._request is not None and span.exception == execution.MAIN:
            if self._request.until == STORE:
                self._end(self._without_the_ticks(span))
            else:
                self._spoil()

    def _note_interrupt(self, span):
        if span.exception == execution.LINE:
            if len(span.received) + span.sent == 1:
                self._served_by(span).note(span.addresses)
        elif span.exception in execution.EDGES:
            self.edges.setdefault(self.edges_at_once, Highest()).note(span.addresses)
        else:
            self.interrupts.setdefault(span.exception, Highest()).note(span.addresses)

    def _served_by(self, span):
        if span.sent:
            return self.sent_byte
        return self.received_byte if self._behind_a_gap.isdisjoint(span.addresses) else self.late_byte

    # --- a pass ---

    def _begin(self, span, main):
        request = self._awaited.get(bytes(self._frame))
        if request is None or not main.addresses:
            return  # not asked for, or not logged
        self._request = request
        self._ahead = max(self._judging, default=0)
        self._set_out(span, main, not self._ends_with_cr)
        if len(span.received) > 1:
            self._spoil()

    def _go_on(self, span, main):
        """ASCII's turn-around is over."""
        if self._request is not None and not self._silent:
            self._ahead = len(self._began.addresses) + max(map(len, self._turns), default=0)
            self._set_out(span, main, True)

    def _set_out(self, span, main, silent):
        self._silent = silent
        self._began = span
        self._main = main
        self._before = len(main.addresses)  # what the main loop had executed when it began
        self._turns = []
        was_asleep = main.addresses[:1] and main.addresses[0] in self._awake and len(main.addresses) <= 2
        if not was_asleep or len(main.interrupts) != 1:
            self._spoil()

    def _without_the_ticks(self, turn):
        addresses = turn.addresses[self._before :] if turn is self._main else turn.addresses
        return [address for address in addresses if address not in self._of_the_tick]

    def _spoil(self):
        self.spoiled += 1
        self._request = None
        self.over = True

    def _end(self, last):
        """The longest of the turns before the last is the one that judged the request, the others are idle;
        all but the first, which begins with the request."""
        turns = self._turns[:1] + sorted(self._turns[1:], key=len)[-1:] + [last]
        began = [] if self._request.until == IGNORED and self._ends_with_cr else self._began.addresses
        highest = self.requests[self._request]
        highest.note(sum(turns, began))
        highest.ahead = max(highest.ahead, self._ahead)
        self._request = None
        self.over = True
