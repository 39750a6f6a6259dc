"""Tests the page of 70 modules on seven lines. With more than 64 modules, the page folds all lines at first."""

import unittest

from panel_page import Panel
from simulator import Master

LINES = [
    {"name": f"hall{n}", "port": "tcp:0", "timing": "instant", "modules": [
        {"model": ("EX9042D-M", "EX9052D-M")[i % 2], "address": f"{i + 1:02X}", "name": f"P{n}V{i}"}
        for i in range(10)]}
    for n in range(7)
]
PLATES = """[...document.querySelectorAll(".line[open]:not([hidden]) .plate")]
    .map((each) => each.getAttribute("aria-label"))"""
SHOWN_LINES = """[...document.querySelectorAll(".line:not([hidden]) .linename")]
    .map((each) => each.firstChild.textContent)"""
OPEN_LINES = """[...document.querySelectorAll(".line[open]:not([hidden]) .linename")]
    .map((each) => each.firstChild.textContent)"""


def entering(words):
    """Returns an expression that enters the words in the field `find`."""
    return f"""((field) => {{ field.value = "{words}"; field.dispatchEvent(new Event("input")) }})(
        document.getElementById("find"))"""


class Plant(Panel):
    def setUp(self):
        super().setUp()
        self.simulator = self.bus(LINES)
        self.browser.open(self.simulator.address)
        self.browser.until(f"{SHOWN_LINES}.length === 7")
        # The page can show the lines before the names of the modules have arrived.
        self.browser.until(f"({entering('p6v9')}, {PLATES}.length === 1)")
        self.find("")

    def find(self, words):
        self.browser.run(entering(words))

    def value(self, expression):
        return self.browser.run(f"return {expression}")

    def test_lines_are_folded_and_a_line_that_is_opened_shows_its_modules(self):
        self.assertEqual(self.value(OPEN_LINES), [])
        self.assertEqual(self.value(PLATES), [])
        self.picture("plant-folded")
        self.browser.click(".line:nth-child(3) > summary")
        self.browser.until(f"{PLATES}.length === 10")
        self.assertEqual(self.value(PLATES)[0], "21 EX9042D-M")
        master = Master(self.simulator.lines[2])
        self.addCleanup(master.close)
        master.ask("01050000FF00", 8)
        lamp = "document.querySelector('[aria-label=\"21 EX9042D-M\"] .output').dataset.on === 'true'"
        self.browser.until(lamp)
        self.picture("plant-one-open")

    def test_an_opened_line_shows_a_state_that_changed_while_the_line_was_folded(self):
        master = Master(self.simulator.lines[2])
        self.addCleanup(master.close)
        master.ask("01050000FF00", 8)
        self.browser.until("document.querySelectorAll('#filler .row:not([data-kind=note])').length === 2")
        self.browser.click(".line:nth-child(3) > summary")
        self.browser.until("document.querySelector('[aria-label=\"21 EX9042D-M\"] .output')?.dataset.on === 'true'")

    def test_modules_are_found_by_line_and_position_and_model_and_address_and_name(self):
        for words, lines, plates in (
            ("hall3", ["hall3"], 10),
            ("p4v7", ["hall4"], 1),
            ("9052 hall5", ["hall5"], 5),
            ("HALL6 0a", ["hall6"], 1),
            ("62 ex9052", ["hall6"], 1),
        ):
            with self.subTest(words=words):
                self.find(words)
                self.assertEqual(self.value(SHOWN_LINES), lines)
                self.assertEqual(self.value(OPEN_LINES), lines)
                self.assertEqual(len(self.value(PLATES)), plates)
                found = "1 module found" if plates == 1 else f"{plates} modules found"
                self.assertEqual(self.value("document.getElementById('found').textContent"), found)
        self.find("nothing like it")
        self.assertEqual(self.value(SHOWN_LINES), [])
        self.picture("plant-nothing-found")

    def test_lines_stay_folded_if_too_many_modules_match_and_an_empty_search_shows_all_lines(self):
        self.find("hall")
        self.assertEqual(len(self.value(SHOWN_LINES)), 7)
        self.assertEqual(self.value(OPEN_LINES), [])
        self.assertEqual(self.value("document.getElementById('found').textContent"), "70 modules found")
        self.find("hall1")
        self.assertNotEqual(self.value(OPEN_LINES), [])
        self.find("")
        self.assertEqual(len(self.value(SHOWN_LINES)), 7)
        self.assertEqual(self.value(OPEN_LINES), [], "some lines are open; all lines must be folded again")
        self.assertEqual(self.value("document.getElementById('found').textContent"), "")

    def test_a_search_shows_only_the_faults_of_the_found_lines(self):
        faults = "[...document.querySelectorAll('.faultline:not([hidden]) h3')].map((each) => each.textContent)"
        self.assertEqual(len(self.value(faults)), 7)
        self.find("hall2")
        self.assertEqual(self.value(faults), ["hall2"])


if __name__ == "__main__":
    unittest.main()
