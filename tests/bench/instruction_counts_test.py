#!/usr/bin/env python3
"""What tests/bench/instructions makes of a log, and of counts."""

import sys
import unittest

sys.dont_write_bytecode = True  # nothing is to be left in the source tree

from instruction_counts import capacity, counter, execution, requests  # noqa: E402

SLEEP = 0x100  # WFI; behind it the main loop goes on at 0x102
TICKS_OWN = 0x300
LATE = 0x2800  # a byte's interrupt ends the frame before it
HANDLERS = {execution.TICK: 0x1000, execution.LINE: 0x2000, execution.SILENCE: 0x3000}


def executed(*addresses):
    return [
        f"Trace 0: 0x7f00 [00800400/{address:08x}/00000110/ff020201] f\n".encode() for address in addresses
    ]


def interrupt(number, *lines):
    """`lines` are addresses, or lines of other events."""
    log = [f"nvic_acknowledge_irq NVIC acknowledge IRQ: {number} now active (prio 0)\n".encode()]
    for line in lines:
        log += executed(line) if isinstance(line, int) else [line]
    return log + [f"nvic_complete_irq NVIC complete IRQ {number} (secure 0)\n".encode()]


def received(byte):
    return f"pl011_read addr 0x00000000 value 0x{byte:08x}\n".encode()


SENT = b"pl011_write addr 0x00000000 value 0x00000021\n"
STORED = b"i2c_event start_async(addr:0x50)\n"
BEGUN_ANEW = b"cpu_io_recompile: rewound execution of TB to 00000200\n"
STOPPED = b"Stopped execution of TB chain before 0x7f00 [00000200] f\n"
MARK = b"pl011_read addr 0x00000fe0 value 0x00000011\n"
ASLEEP = [MARK] + executed(0x200, SLEEP)
WAKES = executed(0x102)
TURN = list(range(0x400, 0x440, 2))  # 32 instructions, so more than it takes to fall asleep


def count(log, frame, until, ends_with_cr, turn_around=True):
    its = counter.Counter(HANDLERS, {SLEEP}, {TICKS_OWN}, {LATE}, ends_with_cr)
    request = requests.Request("it", [frame], until=until, turn_around=turn_around)
    its.expect(request)
    execution.follow(log, {SLEEP}, its)
    return its, its.requests[request]


class Passes(unittest.TestCase):
    RTU = (
        ASLEEP
        + WAKES
        + interrupt(execution.LINE, 0x2000, received(1), 0x2002)
        + executed(0x200, SLEEP)
        + WAKES
    )

    def test_an_rtu_pass_is_the_silence_and_the_main_loop_up_to_the_first_byte(self):
        log = (
            self.RTU
            + interrupt(execution.SILENCE, 0x3000, 0x3002)
            + executed(*TURN)
            + [SENT]
            + executed(0x500)
        )
        its, found = count(log, b"\x01", requests.REPLY, False)
        self.assertEqual((found.passes, found.count), (1, 2 + 32))
        self.assertEqual(its.received_byte.count, 2)

    def test_a_byte_that_ends_the_frame_before_it_is_told_apart(self):
        log = self.RTU + interrupt(execution.LINE, 0x2000, received(1), LATE, 0x2802)
        its, _ = count(log, b"\x01", requests.REPLY, False)
        self.assertEqual((its.received_byte.passes, its.received_byte.count), (1, 2))
        self.assertEqual((its.late_byte.passes, its.late_byte.count), (1, 3))

    def test_what_was_not_executed_after_all_does_not_count(self):
        log = self.RTU + interrupt(execution.SILENCE, 0x3000, BEGUN_ANEW, 0x3000, 0x3002)
        log += executed(*TURN) + [STOPPED] + executed(TURN[-1]) + [SENT]
        self.assertEqual(count(log, b"\x01", requests.REPLY, False)[1].count, 2 + 32)

    def test_a_pass_with_a_tick_in_it_does_not_count(self):
        log = (
            self.RTU
            + interrupt(execution.SILENCE, 0x3000)
            + interrupt(execution.TICK, 0x1000)
            + executed(0x400)
            + [SENT]
        )
        its, found = count(log, b"\x01", requests.REPLY, False)
        self.assertEqual((found.passes, its.spoiled), (0, 1))

    def test_a_pass_that_begins_while_the_main_loop_is_awake_does_not_count(self):
        log = (
            self.RTU
            + executed(0x200, 0x202)
            + interrupt(execution.SILENCE, 0x3000)
            + executed(0x400)
            + [SENT]
        )
        self.assertEqual(count(log, b"\x01", requests.REPLY, False)[1].passes, 0)

    def test_another_frame_does_not_count(self):
        log = self.RTU + interrupt(execution.SILENCE, 0x3000) + executed(0x400) + [SENT]
        self.assertEqual(count(log, b"\x02", requests.REPLY, False)[1].passes, 0)

    def test_a_pass_ends_where_the_store_begins(self):
        log = self.RTU + interrupt(execution.SILENCE, 0x3000) + executed(*TURN) + [STORED] + executed(0x500)
        self.assertEqual(count(log, b"\x01", requests.STORE, False)[1].count, 1 + 32)

    def test_a_reply_without_the_store_that_was_expected_does_not_count(self):
        log = self.RTU + interrupt(execution.SILENCE, 0x3000) + executed(*TURN) + [SENT]
        self.assertEqual(count(log, b"\x01", requests.STORE, False)[1].passes, 0)

    def test_a_foreign_frame_is_the_silence_and_the_way_back_to_sleep(self):
        log = self.RTU + interrupt(execution.SILENCE, 0x3000, 0x3002) + executed(0x200, SLEEP) + WAKES
        self.assertEqual(count(log, b"\x01", requests.IGNORED, False)[1].count, 2 + 2)

    def test_an_ascii_pass_begins_where_the_turn_around_ends_and_what_was_done_before_is_told_apart(self):
        cr = interrupt(execution.LINE, 0x2000, received(0x0D), 0x2002)
        log = ASLEEP + WAKES + cr + executed(*TURN, SLEEP) + WAKES + interrupt(execution.SILENCE, 0x3000)
        log += executed(*TURN) + [SENT]
        found = count(log, b"\r", requests.REPLY, True)[1]
        self.assertEqual((found.count, found.ahead), (1 + 32, 2 + 32 + 1))

    def test_an_ascii_pass_without_a_turn_around_begins_with_cr(self):
        cr = interrupt(execution.LINE, 0x2000, received(0x0D), 0x2002)
        log = ASLEEP + WAKES + cr + executed(*TURN, SLEEP) + WAKES
        found = count(log, b"\r", requests.DONE, True, turn_around=False)[1]
        self.assertEqual((found.count, found.ahead), (2 + 32 + 1, 0))

    def test_an_rtu_pass_tells_what_was_done_since_the_last_byte(self):
        log = ASLEEP + WAKES + interrupt(execution.LINE, 0x2000, received(1)) + executed(*TURN, SLEEP) + WAKES
        log += interrupt(execution.SILENCE, 0x3000) + executed(0x400) + [SENT]
        found = count(log, b"\x01", requests.REPLY, False)[1]
        self.assertEqual((found.count, found.ahead), (1 + 1, 1 + 32 + 1))

    def test_what_has_no_reply_may_wait_for_the_tick_whose_own_work_does_not_count(self):
        cr = interrupt(execution.LINE, 0x2000, received(0x0D))
        log = ASLEEP + WAKES + cr + executed(SLEEP) + WAKES + interrupt(execution.TICK, 0x1000, 0x1002)
        log += executed(TICKS_OWN, *TURN, SLEEP) + WAKES
        found = count(log, b"\r", requests.DONE, True, turn_around=False)[1]
        self.assertEqual(found.count, 1 + 1 + 1 + 32 + 1)

    def test_an_interrupt_with_two_bytes_is_no_measure_of_one(self):
        log = ASLEEP + WAKES + interrupt(execution.LINE, 0x2000, received(1), received(2))
        self.assertEqual(count(log, b"\x01", requests.REPLY, False)[0].received_byte.passes, 0)


class Capacity(unittest.TestCase):
    def test_edges_lie_on_a_straight_line(self):
        found = capacity.Found()
        found.edges = {1: 80, 3: 120, 5: 160}
        self.assertEqual(found.edges_at_once(6), 180)

    def test_a_slower_edge_makes_fewer_of_them(self):
        def pulses(edge):
            found = capacity.Found()
            found.received_byte = 100
            found.edges = {1: edge, 5: 5 * edge}
            found.interrupts = {execution.TICK: 20}
            return int(capacity.capacity(found).split(" pulses a second", maxsplit=1)[0].split()[-1])

        self.assertGreater(pulses(50), pulses(100))


class Requests(unittest.TestCase):
    def test_frames_are_those_of_the_wire(self):
        self.assertEqual(requests.rtu("01 01 0000 000D").hex(), "01010000000dfdcf")
        self.assertEqual(requests.dcon("$012", True), b"$012B7\r")

    def test_names_are_said_once(self):
        model = requests.Model("", 8, 13, True)
        for asked in (requests.modbus_requests(model, True), requests.ascii_requests(model, True, True)):
            names = [request.name for request in asked]
            self.assertEqual(len(names), len(set(names)))


if __name__ == "__main__":
    unittest.main()
