"""The base class and the helpers of the browser tests. Each test starts its own simulator and opens the page of this
simulator. Some tests save pictures in build/panel."""

import atexit
import contextlib
import functools
import itertools
import json
import pathlib
import tempfile
import unittest

from simulator import Master, Simulator, repeating
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
    """Returns a JavaScript expression that is true if exactly these outputs of module 1 are lit. Bit n is output n."""
    lamps = f"""[...document.querySelectorAll("{OUTPUTS} .output")]"""
    return f"{lamps}.reduce((sum, led, n) => sum + (led.dataset.on === 'true' ? 1 << n : 0), 0) === {outputs}"


def text(plate, selector, wanted):
    return f"""document.querySelector("{plate} {selector}").textContent.includes("{wanted}")"""


@functools.cache
def the_browser():
    """Returns one browser for all tests, because the start of a browser takes as long as most tests."""
    browser = Browser()
    atexit.register(browser.close)
    return browser


def bus(lines):
    """Starts a simulator with a bus file of these lines. The program has read the file before this function deletes
    it."""
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump({"lines": lines}, file)
        file.flush()
        return Simulator(file.name)


# Two lines with 32 modules each, in groups of four. The first and the last module of a group have outputs, the second
# has inputs, and the third has both.
MANY = [
    {"name": name, "port": "tcp:0", "modules": [
        {"model": ("EX9042D-M", "EX9052D-M", "EX9055D", "EX9068D-M")[i % 4], "address": f"{i + 1:02X}", "baud": 115200}
        for i in range(32)]}
    for name in ("hall", "yard")
]


@contextlib.contextmanager
def both_lines_busy(simulator):
    """Runs a master on each line while the `with` block runs. The masters send their requests without pauses."""
    with contextlib.ExitStack() as at_the_end:
        masters = [Master(port) for port in simulator.lines]
        for master in masters:
            at_the_end.callback(master.close)
        with repeating(*(requests_of(master) for master in masters)):
            yield


def requests_of(master):
    """Returns a function. Each call of it sends two requests to the next group of four modules. The first request
    switches an output of the first module. The second request reads the inputs of the second module."""
    turns = itertools.count()

    def send():
        turn = next(turns)
        group = turn % 8 * 4
        master.coil(1 + group, turn // 8 % 13, turn // 104 % 2 == 0)
        master.ask(f"{2 + group:02X}0200000008", 6)

    return send


class Panel(unittest.TestCase):
    def setUp(self):
        self.browser = the_browser()
        self.browser.size(*WIDE)
        self.browser.prefers()

    def tearDown(self):
        self.assertEqual(self.browser.logged_errors(), [])
        self.expect_rows_in_order()

    def show(self, *arguments):
        simulator = Simulator(*arguments, "--port", "tcp:0")
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
        """Saves a picture of the page, and expects that the page is accessible."""
        self.browser.screenshot(PICTURES / f"{name}.png", whole)
        self.expect_accessible()

    def expect_accessible(self):
        """Expects that axe-core finds no violation of the Web Content Accessibility Guidelines 2.2, level AA, or of the
        best practices that axe-core defines."""
        self.assertEqual(self.browser.violations(), [])

    def expect_rows_in_order(self):
        """Expects that the document contains the rows of the frame list in the order of their row indices."""
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
