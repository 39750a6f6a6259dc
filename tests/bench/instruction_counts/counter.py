"""Converts the execution log into instruction counts."""

import threading

from instruction_counts import execution


class Highest:
    """Keeps the number of instructions of the longest pass: an interrupt or a turn of the main loop."""

    def __init__(self):
        self.passes = self.count = 0

    def note(self, instructions):
        self.passes += 1
        self.count = max(self.count, instructions)


class Median:
    """Keeps all passes of a request and returns the median. A single pass is not exact: a tick can occur during the
    pass, and a turn of the main loop can follow that feeds the watchdog, or that is not necessary for the request."""

    def __init__(self):
        self._passes = []

    def note(self, instructions):
        self._passes.append(instructions)

    @property
    def passes(self):
        return len(self._passes)

    @property
    def count(self):
        return sorted(self._passes)[(len(self._passes) - 1) // 2]


class Sum:
    """Adds up the instructions of all passes: interrupts and turns of the main loop."""

    def __init__(self):
        self.passes = self.count = 0

    def note(self, instructions):
        self.passes += 1
        self.count += instructions


class Counter:
    """A listener for execution.follow.

    A pass of a request is a whole transaction: the interrupts and the turns of the main loop from `begin` to `end`. The
    pass excludes the interrupts of the tick and of the alarm of this tool, and the turns in which no other interrupt
    occurs.
    """

    def __init__(self, handlers, sleeps):
        self._first = {number: execution.as_logged(address) for number, address in handlers.items()}
        self._awake = {execution.as_logged(address + 2) for address in sleeps}
        self._seen = threading.Event()
        self._pass = None  # number of instructions of the current pass; None between passes
        self.answered = False  # the driver enable has been switched off since `begin`
        self.nothing_happens = False  # set by the caller while it sends no request and changes no input
        # The main loop has gone to sleep. Since then, only the tick and the alarm of this tool have interrupted it.
        self.at_rest = False
        self.requests = {}
        self.edges_at_once = 0
        self.forget()

    def forget(self):
        """Discards the counts of everything that is not a request."""
        self.received_byte = Highest()
        self.sent_byte = Highest()
        self.interrupts = {}  # except those of the UART and of the inputs; by exception number
        self.edges = {}  # by the number of edges that one interrupt serves
        self.ticks_turn = Highest()
        self.idling = Sum()  # all code, except for the alarm of this tool, while `nothing_happens`

    def begin(self):
        """Starts a pass of a request. The main loop must be asleep."""
        self._pass = 0
        self.answered = False
        self.at_rest = True

    def end(self, request):
        """Ends the pass of `request`. The transaction must be complete and the main loop asleep."""
        self.requests.setdefault(request, Median()).note(self._pass)
        self._pass = None

    def wait_until_seen(self, patience):
        """Waits until execution.follow has read the line that Emulator.write_sync_line has written. Call
        write_sync_line first. Raises RuntimeError if this takes longer than `patience` seconds."""
        if not self._seen.wait(patience):
            raise RuntimeError(f"emulator: its log does not continue; expected the next line within {patience} s")
        self._seen.clear()

    # --- events from execution.follow ---

    def seen(self):
        self._seen.set()

    def entered(self, span, _main):
        if span.exception != execution.TICK:
            self.at_rest = False

    def left(self, span, _main):
        if span.addresses[:1] == [self._first.get(span.exception)]:  # the interrupt is logged from its start
            self._note_interrupt(span)
        if self._pass is not None and span.exception != execution.TICK:
            self._pass += len(span.addresses)
        if self.nothing_happens:
            self.idling.note(len(span.addresses))
        if span.exception == execution.LINE_END:
            self.answered = True

    def slept(self, main):
        self.at_rest = True
        if main.addresses[0] not in self._awake:
            return  # logging started during this turn
        if self.nothing_happens and main.interrupts:
            self.idling.note(len(main.addresses))
        if main.interrupts == [execution.TICK]:
            if self.nothing_happens:
                self.ticks_turn.note(len(main.addresses))
        elif main.interrupts and self._pass is not None:
            self._pass += len(main.addresses)

    def _note_interrupt(self, span):
        if span.exception == execution.LINE:
            if len(span.received) + span.sent == 1:
                (self.sent_byte if span.sent else self.received_byte).note(len(span.addresses))
        elif span.exception in execution.EDGES:
            self.edges.setdefault(self.edges_at_once, Highest()).note(len(span.addresses))
        else:
            self.interrupts.setdefault(span.exception, Highest()).note(len(span.addresses))
