"""Tests the appearance of the panel, and what a screen reader finds in it: contrast, roles and names, narrow windows,
the header, the terminals, a timed output, the drawer of a module (its settings and values), and the text that an extra
page shows if too many pages are open."""

import tempfile
import unittest

from panel_page import DI3, INPUTS, OUTPUTS, Panel, text
from simulator import Master, wait_until
from web_socket import Page

MOST_PAGES = 16
LEGIBLE = 4.5  # the minimum contrast ratio that a text requires
VISIBLE = 3  # the minimum contrast ratio that a border requires
# Returns the contrast ratio between a colour and the background colour of the element `ground`. The colour is a
# property of the element `selector`, or of the content generated before or after this element. The ratio includes the
# effect of the opacities of this element and of all its ancestors.
CONTRAST = """
  const [selector, generated, property, ground] = arguments;
  const channels = (colour) => colour.match(/[0-9.]+/g).slice(0, 3).map((each) => Number(each) / 255);
  const light = (colour) => {
    const [r, g, b] = colour.map((each) => each <= 0.04045 ? each / 12.92 : ((each + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const element = document.querySelector(selector);
  const under = channels(getComputedStyle(document.querySelector(ground)).backgroundColor);
  let opacity = 1;
  for (let each = element; each; each = each.parentElement) { opacity *= Number(getComputedStyle(each).opacity); }
  const over = channels(getComputedStyle(element, generated)[property]);
  const [a, b] = [light(under), light(over.map((each, i) => each * opacity + under[i] * (1 - opacity)))];
  return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
"""


class Looks(Panel):
    def test_texts_and_controls_have_enough_contrast_in_light_and_dark(self):
        self.show_two()
        self.browser.run("document.querySelector('.said').textContent = 'error'")
        for scheme in "light", "dark":
            self.browser.prefers(color_scheme=scheme)
            for selector, generated, property_, ground, wanted in (
                (f"{INPUTS} .latch", None, "color", ".plate", LEGIBLE),
                (f"{INPUTS} .counter", None, "color", ".plate", LEGIBLE),
                (DI3, None, "borderTopColor", ".plate", VISIBLE),
                (f"{OUTPUTS} .output", None, "borderTopColor", ".plate", VISIBLE),
                (f"{OUTPUTS} .rocker .knob", "::after", "color", f"{OUTPUTS} .rocker .knob", LEGIBLE),
                (f"{OUTPUTS} .readout .label", None, "color", ".readout", LEGIBLE),
                (f"{INPUTS} .channels .label", None, "color", ".edge", LEGIBLE),
                ("#link", None, "color", ".top", LEGIBLE),
                ("#about", None, "color", ".top", LEGIBLE),
                (".hint", None, "color", "body", LEGIBLE),
                (".lost", None, "color", ".lost", LEGIBLE),
                (".said", None, "color", ".faultline", LEGIBLE),
            ):
                with self.subTest(scheme=scheme, what=selector):
                    self.assertGreaterEqual(self.browser.run(CONTRAST, selector, generated, property_, ground), wanted)
        self.browser.click("[aria-label='1 EX9042D-M: power']")
        self.browser.until(text(OUTPUTS, ".ledtext", "off"))
        knob = f"{OUTPUTS} .rocker .knob"
        for scheme in "light", "dark":
            self.browser.prefers(color_scheme=scheme)
            self.assertGreaterEqual(self.browser.run(CONTRAST, knob, "::after", "color", knob), LEGIBLE)

    def test_a_screen_reader_finds_roles_and_names(self):
        self.show_two()
        nodes = self.browser.devtools("Accessibility.getFullAXTree")["nodes"]
        found = {(each["role"]["value"], each.get("name", {}).get("value", "")) for each in nodes
                 if not each["ignored"] and "role" in each}
        for wanted in (
            ("article", "1 EX9042D-M"), ("heading", "EX9042D-M"), ("image", "Status LED on"), ("image", "DO0 off"),
            ("switch", "1 EX9042D-M: power"), ("switch", "1 EX9042D-M: INIT* to GND"), ("button", "1 EX9042D-M: reset"),
            ("list", "Outputs"), ("list", "Inputs"), ("switch", "2 EX9052D-M: input DI3"),
            ("StaticText", "counter of DI3:"), ("image", "DI3: rising edge not latched"),
            ("region", "Modules"), ("region", "Bus"), ("region", "Faults of the bus"), ("table", "Frames"),
            ("button", "Pause"), ("searchbox", "Search"), ("image", "The last 1000 ms on 1 line"),
            ("switch", "Fault gone"), ("textbox", "Another fault"), ("combobox", "Target of the fault"), ("status", ""),
        ):
            self.assertIn(wanted, found)

    def test_a_drawer_keeps_its_scroll_position_focus_and_selection_while_values_change(self):
        _, master = self.show_two()
        self.browser.size(320, 700)
        self.browser.click(f"{OUTPUTS} summary")
        self.browser.until(text(OUTPUTS, ".values", "Present0000"))
        self.browser.run(f"""
            const table = document.querySelector("{OUTPUTS} .wideable");
            table.focus();
            table.scrollLeft = 30;
            const kept = document.querySelector("{OUTPUTS} .drawer dd");
            getSelection().selectAllChildren(kept);
            window.before = [table, table.scrollLeft, kept, String(getSelection())];""")
        master.coil(1, 0, True)
        master.coil(1, 0x0081, True)
        master.ask("010601E80014", 8)
        self.browser.until(text(OUTPUTS, ".values", "Present1100"))
        self.browser.until(text(OUTPUTS, ".drawer dl", "2.0 s"))
        scrolled, same, focused, selected = self.browser.run(f"""
            const [table, left, kept, selected] = before;
            return [left > 0 && table.scrollLeft === left, document.querySelector("{OUTPUTS} .drawer dd") === kept,
                    document.activeElement === table, selected !== '' && String(getSelection()) === selected];""")
        self.assertTrue(scrolled and same and focused and selected, (scrolled, same, focused, selected))

    def test_the_plate_shows_the_remaining_time_of_an_output_and_the_drawer_shows_the_extensions(self):
        simulator = self.show("EX9055D@01,format=8E1")
        master = Master(simulator.lines[0])
        self.addCleanup(master.close)
        plate = "[aria-label='1 EX9055D']"
        self.browser.click(f"{plate} summary")
        self.browser.until(text(plate, ".drawer dl", "8E1"))
        self.browser.until(text(plate, ".readouts", "9600 8E1"))
        self.assertEqual(master.say("~01X02420064"), "!01")
        self.assertEqual(master.say("~01X02500081"), "!01")
        self.assertEqual(master.say("~01X02510001"), "!01")
        self.assertEqual(master.say("~01RD05"), "!01")
        for shown in ("DI2 100 ms", "DI0, DI7", "host OK and requests", "5 ms"):
            self.browser.until(text(plate, ".drawer dl", shown))
        self.assertEqual(master.say("~01X0283FFFF"), "!01")  # switches output 3 on for 6553.5 s
        left = f"""[...document.querySelectorAll("{plate} .left")]"""
        self.browser.until(f"{left}.filter((each) => !each.hidden).length === 1 && {left}[3].textContent < '6553.0 s'")
        self.picture("timed-output", whole=True)
        self.assertEqual(master.say("@0100"), ">")
        self.browser.until(f"{left}.every((each) => each.hidden)")

    def test_the_drawer_states_where_the_settings_come_from(self):
        with tempfile.NamedTemporaryFile() as image:
            image.write(bytes(8192))
            image.flush()
            simulator = self.show("EX9042D-M@01", f"EX9052D,eeprom={image.name}")
            blank, not_valid = OUTPUTS, "[aria-label='2 EX9052D']"
            for plate, origin in (
                (blank, "EEPROM: blank, factory settings"),
                (not_valid, "EEPROM: no valid copy, factory settings"),
            ):
                self.browser.click(f"{plate} summary")
                self.browser.until(text(plate, ".drawer h4", origin))
            master = Master(simulator.lines[0])
            self.addCleanup(master.close)
            self.assertEqual(master.say("~01ONAME"), "!01")
            self.browser.until(text(not_valid, ".drawer h4", "Settings in EEPROM"))
        self.expect_accessible()

    def let_in(self, simulator):
        """Returns a new page, or None if the server accepts no more pages."""
        page = Page(simulator.port)
        self.addCleanup(page.close)
        return page if page.next() is not None else None

    def test_an_extra_page_reports_the_limit_and_connects_when_another_page_closes(self):
        simulator, _ = self.show_two()
        pages = []
        while len(pages) < MOST_PAGES - 1:
            pages.append(Page(simulator.port))
            self.addCleanup(pages[-1].close)
        self.browser.open("about:blank")
        page = wait_until(lambda: self.let_in(simulator))  # waits until the browser's page has disconnected
        self.browser.open(simulator.address)
        self.browser.until("document.getElementById('lost').textContent.includes('Too many pages')")
        dot = "getComputedStyle(document.getElementById('link'), '::before').content.includes('○')"
        self.browser.until(dot)
        self.picture("too-many")
        page.close()
        self.browser.until("document.querySelectorAll('.plate').length === 2")
        self.browser.until(f"document.getElementById('lost').textContent === '' && !{dot}")
        # Before the first connection, the body has no attribute data-link. The dot must then also show "not connected".
        self.assertTrue(self.browser.run(f"document.body.removeAttribute('data-link'); return {dot}"))

    def test_320_pixels_are_enough_for_long_names(self):
        self.browser.size(320, 640, phone=True)
        modules = [{"model": model, "address": f"{n + 1:02X}"}
                   for n, model in enumerate(("EX9043D-M", "EX9055D", "EX9052D"))]
        self.look_at(self.bus([{"name": name, "port": "tcp:0", "modules": modules} for name in ("n" * 60, "m")]))
        self.browser.run("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
        self.browser.until("document.querySelector('.drawer dd').textContent !== ''")
        self.expect_no_scrolling_sideways()
        self.picture("320", whole=True)

    def test_the_header_does_not_hide_the_focused_element(self):
        self.browser.size(660, 700)
        modules = [{"model": "EX9052D-M", "address": f"{n + 1:02X}"} for n in range(30)]
        self.look_at(self.bus([{"name": "n" * 60, "port": "tcp:0", "modules": modules}]))
        self.browser.run("""document.querySelector("[aria-label='30 EX9052D-M: input DI3']").focus()""")
        hidden = """const header = document.querySelector('.top').getBoundingClientRect();
            return document.activeElement.getBoundingClientRect().top < header.bottom && header.height > 64"""
        self.browser.key("+Shift")
        for _ in range(80):
            self.browser.key("Tab")
            self.assertFalse(self.browser.run(hidden))
        self.browser.key("-Shift")
        self.assertGreater(self.browser.run("return document.querySelector('.top').offsetHeight"), 64)

    def test_terminals_have_the_labels_of_the_model_and_channels_fill_the_width(self):
        self.show("EX9042D-M@01", "EX9052D-M@02", "EX9063D@03")
        edge = """const terminals = document.querySelectorAll(`[aria-label='${arguments[0]}'] .edge li`);
            return [...terminals].map((each) => each.textContent)"""
        power = ["DATA+", "DATA−", "+VS", "GND"]
        self.assertEqual(self.browser.run(edge, "1 EX9042D-M"), ["INIT*", *power])
        self.assertEqual(self.browser.run(edge, "2 EX9052D-M"), power)
        short = """return [...document.querySelectorAll('.channels')].filter((list) =>
            Math.abs(list.lastElementChild.getBoundingClientRect().right
                     - list.getBoundingClientRect().right) > 1).length"""
        self.assertEqual(self.browser.run(short), 0)
        self.picture("terminals", whole=True)


if __name__ == "__main__":
    unittest.main()
