"""What the tests in a browser have in common: the page of a simulator of their own, and a picture of each state in
build/panel."""

import atexit
import contextlib
import functools
import json
import pathlib
import threading
import unittest

from simulator import Master, Simulator
from webdriver import Browser

PICTURES = pathlib.Path(__file__).resolve().parents[2] / "build/panel"

OUTPUTS = "[aria-label='1 EX9042D-M']"
INPUTS = "[aria-label='2 EX9052D-M']"
DI3 = "[aria-label='2 EX9052D-M: input DI3']"
POWER = "[aria-label='1 EX9042D-M: power']"
INIT = "[aria-label='1 EX9042D-M: INIT* to GND']"
WIDE = (1280, 900)
PHONE = (360, 740)


def pressed(selector):
    return f"""document.querySelector("{selector}").getAttribute('aria-checked') === 'true'"""


def lit(outputs):
    """What the lamps of the first module say, bit n for output n."""
    lamps = f"""[...document.querySelectorAll("{OUTPUTS} .output")]"""
    return f"{lamps}.reduce((sum, led, n) => sum + (led.dataset.on === 'true' ? 1 << n : 0), 0) === {outputs}"


def text(plate, selector, wanted):
    return f"""document.querySelector("{plate} {selector}").textContent.includes("{wanted}")"""


@functools.cache
def the_browser():
    """One for all tests: to start it takes as long as most of them."""
    browser = Browser()
    atexit.register(browser.close)
    return browser


def bus(lines):
    path = PICTURES / "bus.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"lines": lines}))
    return Simulator(str(path))


# Two lines of 32 modules each: every four an output module, an input module and two with both.
MANY = [
    {"name": name, "tcp": 0, "modules": [
        {"model": ("EX9042D-M", "EX9052D-M", "EX9055D", "EX9068D-M")[i % 4], "address": f"{i + 1:02X}", "baud": 115200}
        for i in range(32)]}
    for name in ("hall", "yard")
]


@contextlib.contextmanager
def both_lines_busy(simulator):
    """A master on each line as long as the block lasts, without a pause."""
    over = threading.Event()
    loads = [threading.Thread(target=keep_busy, args=(port, over)) for port in simulator.lines]
    for load in loads:
        load.start()
    try:
        yield
    finally:
        over.set()
        for load in loads:
            load.join()


def keep_busy(port, over):
    """Of every four modules one is told to switch an output, and one to read its inputs."""
    master = Master(port)
    turn = 0
    while not over.is_set():
        group = turn % 8 * 4
        master.coil(1 + group, turn // 8 % 13, turn // 104 % 2 == 0)
        master.ask(f"{2 + group:02X}0200000008", 6)
        turn += 1
    master.close()


class Panel(unittest.TestCase):
    def setUp(self):
        self.browser = the_browser()
        self.browser.size(*WIDE)
        self.browser.prefers()

    def tearDown(self):
        self.assertEqual(self.browser.complaints(), [])
        self.expect_rows_in_order()

    def show(self, *arguments):
        simulator = Simulator(*arguments, "--tcp", "0")
        self.addCleanup(simulator.close)
        self.look_at(simulator)
        return simulator

    def look_at(self, simulator):
        self.browser.open(simulator.address)
        self.browser.until("document.querySelector('.plate .readout .value').textContent !== ''")

    def show_two(self):
        simulator = self.show("EX9042D-M@01", "EX9052D-M@02")
        master = Master(simulator.lines[0])
        self.addCleanup(master.close)
        return simulator, master

    def picture(self, name, whole=False):
        """Of a state of the page, which has to be accessible too."""
        self.browser.screenshot(PICTURES / f"{name}.png", whole)
        self.expect_accessible()

    def expect_accessible(self):
        """axe-core finds nothing against the Web Content Accessibility Guidelines 2.2, level AA."""
        self.assertEqual(self.browser.violations(), [])

    def expect_rows_in_order(self):
        """The frame list's rows stand in the document as they are seen."""
        order = """return [...document.querySelectorAll('#filler .row')].map((row) => Number(row.ariaRowIndex))"""
        rows = self.browser.run(order)
        self.assertEqual(rows, sorted(rows))

    def expect_no_scrolling_sideways(self):
        self.assertLessEqual(*self.browser.run(
            "const {scrollWidth, clientWidth} = document.documentElement; return [scrollWidth, clientWidth]"))

    def many(self):
        return self.bus(MANY)

    def bus(self, lines):
        simulator = bus(lines)
        self.addCleanup(simulator.close)
        return simulator
