"""From what was executed to counts."""

import threading

from instruction_counts import execution


class Highest:
    """The pass with the most instructions."""

    def __init__(self):
        self.passes = 0
        self.addresses = []

    def note(self, addresses):
        self.passes += 1
        if len(addresses) > len(self.addresses):
            self.addresses = addresses

    @property
    def count(self):
        return len(self.addresses)


class Median:
    """The pass in the middle: into some a tick falls, and of a turn that does something else too not all that is
    done for the tick can be told apart."""

    def __init__(self):
        self._passes = []

    def note(self, addresses):
        self._passes.append(addresses)

    @property
    def passes(self):
        return len(self._passes)

    @property
    def addresses(self):
        return sorted(self._passes, key=len)[(len(self._passes) - 1) // 2]

    @property
    def count(self):
        return len(self.addresses)


class Sum:
    """All of them."""

    def __init__(self):
        self.passes = 0
        self.addresses = []

    def note(self, addresses):
        self.passes += 1
        self.addresses += addresses

    @property
    def count(self):
        return len(self.addresses)


class Counter:
    """Listens to execution.follow.

    A pass is a whole transaction: all interrupts and all turns of the main loop from `begin` to `end`, the
    tick subtracted: its interrupt, the turn that nothing else has woken, and what another turn does for it. Nor
    does it have turns that only the tool's own alarm has woken.
    """

    def __init__(self, handlers, sleeps, of_the_tick):
        self._first = {number: execution.as_logged(address) for number, address in handlers.items()}
        self._awake = {execution.as_logged(address + 2) for address in sleeps}
        self._of_the_tick = {execution.as_logged(address) for address in of_the_tick}
        self._seen = threading.Event()
        self._pass = None  # addresses, while one is under way
        self.answered = False  # the driver went off
        self.nothing_happens = False  # but ticks
        self.at_rest = False  # the main loop fell asleep, and no interrupt has come since
        self.requests = {}
        self.edges_at_once = 0
        self.forget()

    def forget(self):
        """Begins to count what is not a request."""
        self.received_byte = Highest()
        self.sent_byte = Highest()
        self.interrupts = {}  # others, by the number of the exception
        self.edges = {}  # by how many were served at once
        self.ticks_turn = Highest()
        self.idling = Sum()  # all that is executed while nothing happens

    def begin(self):
        """The main loop sleeps."""
        self._pass = []
        self.answered = False
        self.at_rest = True

    def end(self, request):
        """`request` is done, and the main loop sleeps."""
        self.requests.setdefault(request, Median()).note(self._pass)
        self._pass = None

    def wait_until_seen(self, patience):
        """What Emulator.ask_for_sight, called before, asked for."""
        if not self._seen.wait(patience):
            raise RuntimeError("the emulator's log has ended")
        self._seen.clear()

    # --- what execution.follow tells ---

    def seen(self):
        self._seen.set()

    def entered(self, span, _main):
        if span.exception != execution.TICK:
            self.at_rest = False

    def left(self, span, _main):
        if span.addresses[:1] == [self._first.get(span.exception)]:  # logged from its begin on
            self._note_interrupt(span)
        if self._pass is not None and span.exception != execution.TICK:
            self._pass += span.addresses
        if self.nothing_happens:
            self.idling.note(span.addresses)
        if span.exception == execution.LINE_END:
            self.answered = True

    def slept(self, main):
        self.at_rest = True
        if main.addresses[0] not in self._awake:
            return  # logging began in between
        if self.nothing_happens and main.interrupts:
            self.idling.note(main.addresses)
        if main.interrupts == [execution.TICK]:
            if self.nothing_happens:
                self.ticks_turn.note(main.addresses)
        elif main.interrupts and self._pass is not None:
            self._pass += [address for address in main.addresses if address not in self._of_the_tick]

    def _note_interrupt(self, span):
        if span.exception == execution.LINE:
            if len(span.received) + span.sent == 1:
                (self.sent_byte if span.sent else self.received_byte).note(span.addresses)
        elif span.exception in execution.EDGES:
            self.edges.setdefault(self.edges_at_once, Highest()).note(span.addresses)
        else:
            self.interrupts.setdefault(span.exception, Highest()).note(span.addresses)
