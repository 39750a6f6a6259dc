"""Calculates from instruction counts how many pulses per second a TM4C123 can count on each input. Nothing is measured
on a board."""

import math

from instruction_counts import execution

HERTZ = 50_000_000
CYCLES_AN_INSTRUCTION = 1.6
CYCLES_AROUND_AN_INTERRUPT = 24  # entry and exit
BAUD = 115200
BITS_A_CHARACTER = 10
TICKS_A_SECOND = 100
LEFT_TO_THE_MAIN_LOOP = 0.1
PORTS = (6, 2)  # number of inputs on each port: boards/ek-tm4c123gxl/board.hpp


def cycles(instructions):
    return CYCLES_AN_INSTRUCTION * instructions + CYCLES_AROUND_AN_INTERRUPT


class Found:
    """The highest counts of one or more sessions."""

    def __init__(self):
        self.received_byte = 0
        self.sent_byte = 0
        self.interrupts = {}
        self.edges = {}  # number of edges that one interrupt serves -> instructions of this interrupt

    def add(self, counter):
        """Replaces each count if the count of `counter`, a counter.Counter, is higher."""
        self.received_byte = max(self.received_byte, counter.received_byte.count)
        self.sent_byte = max(self.sent_byte, counter.sent_byte.count)
        for mine, its in ((self.interrupts, counter.interrupts), (self.edges, counter.edges)):
            for key, highest in its.items():
                mine[key] = max(mine.get(key, 0), highest.count)

    def merge(self, other):
        self.received_byte = max(self.received_byte, other.received_byte)
        self.sent_byte = max(self.sent_byte, other.sent_byte)
        for mine, its in ((self.interrupts, other.interrupts), (self.edges, other.edges)):
            for key, count in its.items():
                mine[key] = max(mine.get(key, 0), count)

    def edges_at_once(self, edges):
        """Returns the number of instructions of an interrupt that serves this many edges. Calculates it linearly from
        the counts for one edge and for the largest measured number of edges."""
        most = max(self.edges)
        one = self.edges[1]
        return one + (edges - 1) * (self.edges[most] - one) / (most - 1)


def capacity(found):
    """Returns the text to print."""
    ports = [cycles(found.edges_at_once(edges)) for edges in PORTS]
    byte = cycles(found.received_byte)
    tick = cycles(found.interrupts[execution.TICK])
    busy = byte * BAUD / BITS_A_CHARACTER / HERTZ + tick * TICKS_A_SECOND / HERTZ
    left = max(0.0, 1 - busy - LEFT_TO_THE_MAIN_LOOP)
    # In the worst case, an edge waits for one run of each other interrupt, and then until its own interrupt ends.
    waits = (
        sum(ports)
        + max(byte, cycles(found.sent_byte))
        + sum(cycles(count) for count in found.interrupts.values())
    )
    wait = waits / HERTZ
    pulses = min(left * HERTZ / sum(ports) / 2, 1 / wait)
    return "\n".join(
        [
            f"computed, not measured, for a TM4C123 at {HERTZ // 1_000_000} MHz with {CYCLES_AN_INSTRUCTION} cycles "
            f"per instruction and {CYCLES_AROUND_AN_INTERRUPT} cycles for the entry and exit of an interrupt:",
            f"  the processor serves eight edges at once in {sum(ports) / HERTZ * 1e6:.1f} us, and a received byte in "
            f"{byte / HERTZ * 1e6:.1f} us; the byte takes {BITS_A_CHARACTER / BAUD * 1e6:.1f} us on the line at {BAUD} "
            "baud",
            f"  if the line carries bytes without a pause at {BAUD} baud, and {LEFT_TO_THE_MAIN_LOOP:.0%} of the time "
            f"is left to the main loop, the module counts {math.floor(pulses / 100) * 100} pulses a second on each of "
            "eight inputs at the same time, with both edges of each pulse served",
            f"  an edge is served within {math.ceil(wait * 1e6)} us, even if all other interrupts are pending: both "
            "edges of a pulse of at least this length are detected; a shorter pulse is still counted if the pulse and "
            "the following gap together have at least this length",
        ]
    )
