"""What the tests in a browser have in common: the page of a simulator of their own, and a picture of each state in
build/panel."""

import atexit
import functools
import json
import pathlib
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


class Panel(unittest.TestCase):
    def setUp(self):
        self.browser = the_browser()
        self.browser.size(*WIDE)
        self.browser.prefers()

    def tearDown(self):
        self.assertEqual(self.browser.complaints(), [])

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
        self.browser.screenshot(PICTURES / f"{name}.png", whole)

    def expect_no_scrolling_sideways(self):
        self.assertLessEqual(*self.browser.run(
            "const {scrollWidth, clientWidth} = document.documentElement; return [scrollWidth, clientWidth]"))

    def many(self):
        models = ["EX9042D-M", "EX9052D-M", "EX9055D", "EX9068D-M"]
        modules = [{"model": models[i % 4], "address": f"{i + 1:02X}", "baud": 115200} for i in range(32)]
        return self.bus([{"name": name, "tcp": 0, "modules": modules} for name in ("hall", "yard")])

    def bus(self, lines):
        path = PICTURES / "bus.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps({"lines": lines}))
        simulator = Simulator(str(path))
        self.addCleanup(simulator.close)
        return simulator
