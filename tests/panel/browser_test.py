"""Tests the panel in a real browser: user actions, module events, and the display. Saves pictures in build/panel."""

import unittest

from panel_page import DI3, INIT, INPUTS, OUTPUTS, PHONE, POWER, Panel, both_lines_busy, lit, pressed, text
from simulator import Master, crc, repeating

CLICKS = 24
READ_INPUTS = bytes.fromhex("020200000008") + crc(bytes.fromhex("020200000008"))


class Modules(Panel):
    def test_the_page_and_modbus_show_one_count_after_two_clicks_on_an_input(self):
        _, master = self.show_two()
        counted = text(INPUTS, "li:nth-child(4) .count", "1")
        self.assertEqual(master.counter(2, 3), 0)
        self.browser.click(DI3)
        self.browser.until(pressed(DI3))
        self.assertEqual(master.counter(2, 3), 0)
        self.browser.click(DI3)
        self.browser.until(counted)
        self.assertEqual(master.counter(2, 3), 1)
        self.picture("counted")

    def test_the_page_shows_the_expiry_of_a_host_watchdog(self):
        _, master = self.show_two()
        master.coil(1, 0x0081, True)  # the safe value of output 1
        master.ask("010F0000000D020500", 8)
        self.browser.until(lit(5))
        self.browser.click("summary")
        self.browser.until(text(OUTPUTS, ".values", "Safe0100"))
        master.ask("010601E800FF", 8)
        master.coil(1, 0x0104, True)
        with repeating(lambda: master.ask("010601E800FF", 8)):  # restarts the host watchdog
            self.browser.until(text(OUTPUTS, ".readout.wide .value", "of 25.5 s"))
            self.picture("counting-down")
        master.ask("010601E80014", 8)
        self.browser.until("document.querySelector('.status').dataset.led === 'flashing'")
        self.browser.until(lit(2))
        self.browser.until(text(OUTPUTS, ".ledtext", "flashing"))
        self.browser.until(text(OUTPUTS, ".readout.wide .value", "timed out"))
        running = "getComputedStyle(document.querySelector('.status')).animationName"
        self.assertEqual(self.browser.run(f"return {running}"), "flash")
        self.picture("timed-out", whole=True)
        self.browser.prefers(reduced_motion="reduce")
        self.assertEqual(self.browser.run(f"return {running}"), "none")
        self.browser.until(text(OUTPUTS, ".ledtext", "flashing"))
        self.picture("timed-out-without-motion")

    def test_a_power_cycle_with_init_lets_the_master_read_a_lost_address(self):
        simulator = self.show("EX9042D-M@5A,baud=19200,protocol=modbus", "--baud", "9600")
        master = Master(simulator.lines[0])
        self.addCleanup(master.close)
        self.browser.until(text(OUTPUTS, ".readouts", "5A"))
        self.browser.click(INIT)
        self.browser.until(pressed(INIT))
        self.browser.click(POWER)
        self.browser.until(text(OUTPUTS, ".ledtext", "off"))
        self.picture("without-power")
        self.browser.click(POWER)
        self.browser.until(text(OUTPUTS, ".ledtext", "INIT mode"))
        self.browser.until(text(OUTPUTS, ".readouts", "9600"))
        self.assertEqual(master.say("$002"), "!5A400700")
        self.picture("init-mode")

    def test_the_page_reports_a_killed_simulator_and_connects_to_the_next_run(self):
        simulator, _ = self.show_two()
        self.browser.click(DI3)
        self.browser.until(pressed(DI3))
        lost = "document.getElementById('lost').textContent.includes('trying again')"
        simulator.kill()
        self.browser.until(lost)
        self.assertTrue(self.browser.run(f"return {pressed(DI3)}"))  # unchanged
        self.picture("lost")
        simulator.start_again()
        self.browser.until(f"!({lost})")
        self.browser.until(f"!({pressed(DI3)})")  # off, because the simulator has started again
        self.browser.click(DI3)
        self.browser.until(pressed(DI3))

    def test_the_keyboard_reaches_the_controls_of_the_modules_and_operates_an_input(self):
        self.show_two()
        focused = "return document.activeElement.getAttribute('aria-label')"
        seen = []
        while len(seen) < 60 and "2 EX9052D-M: reset" not in seen:
            self.browser.key("Tab")
            seen.append(self.browser.run(focused))
            if seen[-1] == "2 EX9052D-M: input DI3":
                outline = "return getComputedStyle(document.activeElement).outlineStyle"
                self.assertEqual(self.browser.run(outline), "solid")
                self.picture("by-keyboard")
                self.browser.key("Space")
                self.browser.until(pressed(DI3))
                self.browser.key("Enter")
                self.browser.until(f"!({pressed(DI3)})")
                self.browser.key("+Shift", "+Space")
                self.browser.until(pressed(DI3))
                self.browser.key("-Space", "-Shift")
                self.browser.until(f"!({pressed(DI3)})")
        first = ("1 EX9042D-M: power", "1 EX9042D-M: INIT* to GND", "1 EX9042D-M: reset")
        for name in *first, "2 EX9052D-M: input DI0", "2 EX9052D-M: input DI3", "2 EX9052D-M: reset":
            self.assertIn(name, seen)
        nameless = """return [...document.querySelectorAll('button, input, select, [role=img], [role=switch]')]
            .filter((each) => !(each.getAttribute('aria-label') || each.labels?.length || each.textContent.trim()))
            .map((each) => each.outerHTML)"""
        self.assertEqual(self.browser.run(nameless), [])

    def test_faults_can_be_switched_on_and_off_and_the_page_shows_their_effect(self):
        _, master = self.show_two()
        noise = "[aria-label='Fault inserted-bytes 0.01']"
        self.browser.type("[aria-label='Another fault']", "nonsense\ue007")
        self.browser.until("document.querySelector('.said').textContent.includes('is not a fault')")
        self.browser.click(noise)
        self.browser.until(pressed(noise))
        self.browser.run("document.getElementById('bus').scrollIntoView()")
        error = "document.querySelector('.row[data-kind=error]') !== null"
        for _ in range(200):
            before = self.browser.run("return document.getElementById('tally').textContent")
            master.send(READ_INPUTS)  # there may be no reply, so do not wait for one
            self.browser.until("document.getElementById('tally').textContent !== given[0]", before)
            if self.browser.run(f"return {error}"):
                break
        self.browser.until(error)
        self.picture("noise")
        self.browser.run(f'document.querySelector("{noise}").click()')
        self.browser.until(f"!({pressed(noise)})")

    def test_a_phone_shows_one_module_or_64_modules_without_horizontal_scrolling(self):
        self.browser.size(*PHONE, phone=True)
        self.show("EX9043D-M@01,baud=115200")
        self.browser.run("document.querySelector('details').open = true")
        self.browser.until("document.querySelector('.values') !== null")
        self.expect_no_scrolling_sideways()
        self.picture("phone", whole=True)
        self.browser.prefers(color_scheme="dark")
        self.picture("phone-dark", whole=True)
        self.look_at(self.many())
        self.expect_no_scrolling_sideways()
        self.picture("phone-64")

    def test_the_picture_for_the_readme_shows_the_outputs_that_are_on(self):
        self.browser.size(1060, 900)
        _, master = self.show_two()
        self.browser.click("[aria-label='2 EX9052D-M: input DI1']")
        self.browser.click("input[value=pulse]")
        for _ in range(3):
            self.browser.click("[aria-label='2 EX9052D-M: input DI6']")
        self.browser.click("input[value=toggle]")
        self.browser.run("document.activeElement.blur()")
        master.ask("010601E800C8", 8)
        master.coil(1, 0x0104, True)
        for turn in range(12):
            master.coil(1, turn % 6 * 2, True)
            master.ask("020200000008", 6)
            master.counter(2, 6)
        self.browser.until(lit(0x0555))
        self.picture("readme")

    def test_a_single_module_shows_pressed_inputs_in_light_and_dark(self):
        self.show("EX9055D@01,name=PUMPS")
        for channel in 1, 4:
            self.browser.click(f"[aria-label='1 EX9055D: input DI{channel}']")
        self.browser.until(pressed("[aria-label='1 EX9055D: input DI4']"))
        self.picture("one")
        self.browser.prefers(color_scheme="dark")
        self.picture("one-dark")

    def test_the_page_shows_64_modules_and_every_click_while_both_lines_are_fully_loaded(self):
        simulator = self.many()
        with self.browser.patient():  # otherwise the page may give up its connection on a busy host
            self.look_at(simulator)
        self.assertEqual(self.browser.run("return document.querySelectorAll('.plate').length"), 64)
        input_, plate = "[aria-label='2 EX9052D-M: input DI3']", "[aria-label='2 EX9052D-M']"
        count = f"""Number(document.querySelector("{plate} li:nth-child(4) .count").textContent)"""
        there = "document.getElementById('lost').textContent === ''"
        latched = f"""document.querySelector("{plate} li:nth-child(4) .latch").dataset.on === 'true'"""
        with both_lines_busy(simulator):
            self.browser.until("document.querySelectorAll('#filler .row').length > 10")
            # The module's counter counts falling edges: one for every two clicks.
            for _ in range(CLICKS):
                self.browser.run(f"""window.was = [{pressed(input_)}, {count}];
                    document.querySelector("{input_}").click()""")
                self.browser.until(f"""{pressed(input_)} !== was[0] && {latched} &&
                    {count} === was[1] + (was[0] ? 1 : 0)""")
            self.assertTrue(self.browser.run(f"return {there}"))
            self.picture("64")
            self.browser.prefers(color_scheme="dark")
            self.browser.run("document.getElementById('bus').scrollIntoView()")
            self.picture("64-bus-dark")
        print(f"64 modules, both lines at full load: the page shows each of {CLICKS} clicks", flush=True)


if __name__ == "__main__":
    unittest.main()
