"""Tests the inputs on the page. The tests switch, hold or pulse inputs with a mouse, a finger and keys, and with
clicks without a pointer. One test presses the reset button of a module."""

import unittest

from panel_page import DI3, INPUTS, Panel, pressed
from web_socket import Page

COUNT = f"""Number(document.querySelector("{INPUTS} li:nth-child(4) .count").textContent)"""
LOST = "document.getElementById('lost').textContent.includes('trying again')"
HOLD = "input[value=hold]"
PULSE = "input[value=pulse]"


class Inputs(Panel):
    def click_in_the_page(self, selector, times=1):
        """Clicks `times` times as a screen reader does, without a pointer and without keys."""
        self.browser.run(f"""for (let i = 0; i < {times}; ++i) {{ document.querySelector("{selector}").click(); }}""")

    def middle_of(self, selector):
        return self.browser.run(f"""const box = document.querySelector("{selector}").getBoundingClientRect();
            return [box.x + box.width / 2, box.y + box.height / 2]""")

    def focus(self, selector):
        self.browser.run(f"""document.querySelector("{selector}").focus()""")

    def test_a_held_input_is_released_when_a_hang_of_the_simulator_ends(self):
        simulator, _ = self.show_two()
        self.browser.click("[aria-label='2 EX9052D-M: input DI1']")
        self.browser.click(HOLD)
        self.browser.pointer(DI3, "down")
        self.browser.until(pressed(DI3))
        simulator.stop()
        self.browser.until(LOST)
        self.assertTrue(self.browser.run(f"return {pressed(DI3)}"))  # the page shows the last known state
        self.browser.pointer("up")
        simulator.go_on()
        self.browser.until(f"!({LOST})")
        self.browser.until(f"!({pressed(DI3)})")
        # DI1 is still on, because the simulator has not started again.
        self.assertTrue(self.browser.run("return " + pressed("[aria-label='2 EX9052D-M: input DI1']")))
        self.browser.click("input[value=toggle]")
        self.browser.click(DI3)
        self.browser.until(pressed(DI3))

    def test_a_held_input_is_released_when_the_page_closes(self):
        simulator, _ = self.show_two()
        self.browser.click(HOLD)
        self.browser.pointer(DI3, "down")
        self.browser.until(pressed(DI3))
        self.look_at(simulator)
        self.browser.until(f"!({pressed(DI3)}) && {COUNT} === 1")
        self.browser.pointer("up")

    def test_each_of_several_fast_clicks_switches_the_input(self):
        _, master = self.show_two()
        self.click_in_the_page(DI3, 5)
        self.browser.until(f"{pressed(DI3)} && {COUNT} === 2")
        self.assertEqual(master.counter(2, 3), 2)
        self.click_in_the_page(DI3, 2)
        self.browser.until(f"{pressed(DI3)} && {COUNT} === 3")

    def test_a_click_after_a_hold_by_keys_is_not_lost(self):
        self.show_two()
        self.focus(DI3)
        self.browser.key("+Shift", "+Space")
        self.browser.until(pressed(DI3))
        self.browser.key("-Space", "-Shift")
        self.browser.until(f"!({pressed(DI3)})")
        self.click_in_the_page(DI3)
        self.browser.until(pressed(DI3))

    def test_in_hold_mode_a_click_without_a_pointer_switches_the_input(self):
        self.show_two()
        self.browser.click(HOLD)
        self.click_in_the_page(DI3)
        self.browser.until(pressed(DI3))

    def test_a_moving_finger_holds_an_input_until_the_touch_ends_or_is_cancelled(self):
        self.show_two()
        self.browser.devtools("Emulation.setTouchEmulationEnabled", enabled=True)
        self.addCleanup(self.browser.devtools, "Emulation.setTouchEmulationEnabled", enabled=False)
        self.browser.click(HOLD)
        x, y = self.middle_of(DI3)
        for turn, over in enumerate(("end", "cancel")):
            self.browser.touch("start", x, y)
            self.browser.until(pressed(DI3))
            for step in 1, 2:
                self.browser.touch("move", x, y - 60 * step)
            self.assertEqual(self.browser.run("return scrollY"), 0)
            self.browser.run("""
                window.seen = new Promise((shown) => requestAnimationFrame(() => requestAnimationFrame(shown)));
            """)
            self.browser.promised("await seen")
            self.assertTrue(self.browser.run(f"return {pressed(DI3)}"))
            self.browser.touch(over)
            self.browser.until(f"!({pressed(DI3)}) && {COUNT} === {turn + 1}")
        self.click_in_the_page(DI3)
        self.browser.until(pressed(DI3))

    def test_a_click_with_alt_gives_a_pulse_and_a_key_in_pulse_mode_gives_a_pulse(self):
        self.show_two()
        self.browser.key("+Alt")
        self.browser.click(DI3)
        self.browser.key("-Alt")
        self.browser.until(f"{COUNT} === 1")
        self.browser.click(PULSE)
        for turn, key in enumerate(("Space", "Enter")):
            self.focus(DI3)
            self.browser.key(key)
            self.browser.until(f"{COUNT} === {turn + 2}")
        self.assertFalse(self.browser.run(f"return {pressed(DI3)}"))

    def test_the_reset_button_sets_an_output_to_its_power_on_value(self):
        simulator, master = self.show_two()
        master.coil(1, 0, True)
        page = Page(simulator.port)
        self.addCleanup(page.close)
        self.assertEqual(page.tell("1 outputs")["text"], "ok 0001")
        self.browser.click("[aria-label='1 EX9042D-M: reset']")
        self.browser.until("document.querySelector('.output').dataset.on === 'false'")
        self.assertEqual(page.tell("1 outputs")["text"], "ok 0000")


if __name__ == "__main__":
    unittest.main()
