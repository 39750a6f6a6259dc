#!/usr/bin/env python3
"""Tests how tests/bench/instructions evaluates an execution log and computes results from instruction counts. Also
tests the requests of that tool."""

import sys
import unittest

sys.dont_write_bytecode = True  # do not leave byte code in the source tree

from instruction_counts import capacity, counter, execution, requests  # noqa: E402

SLEEP = 0x100  # address of WFI, after which the main loop continues at 0x102
NUMBERS = execution.LM3S6965
HANDLERS = {execution.TICK: 0x1000, NUMBERS.line: 0x2000, NUMBERS.silence: 0x3000, NUMBERS.line_end: 0x4000}


def executed(*addresses):
    return [
        f"Trace 0: 0x7f00 [00800400/{address:08x}/00000110/ff020201] f\n".encode() for address in addresses
    ]


def interrupt(number, *lines):
    """Returns the log of an interrupt. `lines` are addresses of executed instructions, or log lines of other events."""
    log = [f"nvic_acknowledge_irq NVIC acknowledge IRQ: {number} now active (prio 0)\n".encode()]
    for line in lines:
        log += executed(line) if isinstance(line, int) else [line]
    return log + [f"nvic_complete_irq NVIC complete IRQ {number} (secure 0)\n".encode()]


def received(byte):
    return f"pl011_read addr 0x00000000 value 0x{byte:08x}\n".encode()


SENT = b"pl011_write addr 0x00000000 value 0x00000021\n"
BEGUN_ANEW = b"cpu_io_recompile: rewound execution of TB to 00000200\n"
STOPPED = b"Stopped execution of TB chain before 0x7f00 [00000200] f\n"
MARK = b"pl011_read addr 0x00000fe0 value 0x00000011\n"
ASLEEP = [MARK] + executed(0x200, SLEEP)
TURN = list(range(0x400, 0x440, 2))  # 32 instructions
TICK = interrupt(execution.TICK, 0x1000, 0x1002)


def turn(interrupts, *addresses):
    """Returns the log of a turn: the main loop wakes up, the `interrupts` occur, and the main loop continues and sleeps
    again. The main loop executes 2 instructions plus `addresses`."""
    return executed(0x102) + interrupts + executed(*addresses, SLEEP)


def count(log):
    its = counter.Counter(HANDLERS, {SLEEP}, NUMBERS)
    request = requests.Request("it", [b"\x01"])
    its.begin()
    its.nothing_happens = True
    execution.follow(log + executed(0x102), {SLEEP}, its)
    its.end(request)
    return its, its.requests[request].count


class Passes(unittest.TestCase):
    BYTE = interrupt(NUMBERS.line, 0x2000, received(1), 0x2002)

    def test_the_interrupts_and_the_turns_and_the_single_bytes_of_an_answered_request_are_counted(self):
        log = ASLEEP + turn(self.BYTE) + turn(interrupt(NUMBERS.silence, 0x3000), *TURN)
        log += turn(interrupt(NUMBERS.line, 0x2000, SENT)) + turn(interrupt(NUMBERS.line_end, 0x4000), 0x500)
        its, found = count(log)
        self.assertEqual(found, (2 + 2) + (1 + 2 + 32) + (1 + 2) + (1 + 2 + 1))
        self.assertEqual((its.received_byte.count, its.sent_byte.count), (2, 1))
        self.assertTrue(its.answered)

    def test_a_pass_excludes_the_tick_and_its_turn_which_is_counted_separately(self):
        its, found = count(ASLEEP + turn(self.BYTE) + turn(TICK, *TURN) + turn(self.BYTE))
        self.assertEqual(found, 2 * (2 + 2))
        self.assertEqual(its.ticks_turn.count, 2 + 32)

    def test_at_rest_all_interrupts_and_turns_count_except_those_of_the_alarm_of_the_tool(self):
        log = ASLEEP + turn(TICK, *TURN) + turn(interrupt(execution.ALARM, 0x5000))
        log += turn(interrupt(NUMBERS.wake, 0x6000), 0x500)
        self.assertEqual(count(log)[0].idling.count, (2 + 2 + 32) + (1 + 2 + 1))

    def test_a_pass_excludes_a_turn_that_the_alarm_of_the_tool_starts(self):
        log = ASLEEP + turn(interrupt(execution.ALARM, 0x5000)) + turn(self.BYTE)
        self.assertEqual(count(log)[1], 2 + 2)

    def test_a_logged_instruction_that_was_not_executed_does_not_count(self):
        byte = interrupt(NUMBERS.line, 0x2000, BEGUN_ANEW, 0x2000, received(1), 0x2002)
        log = ASLEEP + executed(0x102) + byte + executed(0x400) + [STOPPED] + executed(0x400, SLEEP)
        self.assertEqual(count(log)[1], 2 + 3)

    def test_the_module_is_at_rest_from_the_sleep_of_the_main_loop_to_the_next_interrupt_other_than_the_tick(self):
        self.assertTrue(count(ASLEEP + turn(self.BYTE) + turn(TICK))[0].at_rest)
        self.assertFalse(count(ASLEEP + executed(0x102) + self.BYTE)[0].at_rest)

    def test_a_request_is_not_answered_until_the_driver_enable_is_switched_off(self):
        self.assertFalse(count(ASLEEP + turn(interrupt(NUMBERS.line, 0x2000, SENT)))[0].answered)

    def test_an_interrupt_with_two_bytes_does_not_count_as_one_byte(self):
        its, found = count(ASLEEP + turn(interrupt(NUMBERS.line, 0x2000, received(1), received(2))))
        self.assertEqual((its.received_byte.passes, found), (0, 1 + 2))


class Capacity(unittest.TestCase):
    def test_the_instruction_count_for_more_edges_than_were_measured_is_extrapolated_linearly(self):
        found = capacity.Found()
        found.edges = {1: 80, 3: 120, 5: 160}
        self.assertEqual(found.edges_at_once(6), 180)

    def test_more_instructions_per_edge_lower_the_pulse_rate(self):
        def pulses(edge):
            found = capacity.Found()
            found.received_byte = 100
            found.edges = {1: edge, 5: 5 * edge}
            found.interrupts = {execution.TICK: 20}
            return int(capacity.capacity(found).split(" pulses a second", maxsplit=1)[0].split()[-1])

        self.assertGreater(pulses(50), pulses(100))


class Requests(unittest.TestCase):
    def test_frames_have_the_checksum_that_the_protocol_requires(self):
        self.assertEqual(requests.rtu("01 01 0000 000D").hex(), "01010000000dfdcf")
        self.assertEqual(requests.dcon("$012", True), b"$012B7\r")

    def test_the_names_of_requests_are_unique(self):
        model = requests.Model("", 8, 13, True)
        for asked in (requests.modbus_requests(model, True), requests.ascii_requests(model, True, True)):
            names = [request.name for request in asked]
            self.assertEqual(len(names), len(set(names)))


if __name__ == "__main__":
    unittest.main()
