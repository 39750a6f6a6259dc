"""Tests the console of a line in the browser."""

import unittest

from panel_page import MANY, Panel, lit

FORM = "#consoles details"
MODULE = f"{FORM} select[aria-label^='Module']"
ITEM = f"{FORM} select[aria-label^='Item']"
REQUEST = f"{FORM} input[type=text]"
SEND = f"{FORM} button"
POLL = f"{FORM} input[type=checkbox]"
REPLIES = f"[...document.querySelectorAll('{FORM} .replies > div')].map((each) => each.textContent)"
ITEMS = f"""[...document.querySelector("{ITEM}").options].map((each) => each.textContent)"""


class Console(Panel):
    def open(self, *modules):
        self.show(*modules)
        self.browser.click(f"{FORM} > summary")
        self.browser.until(f"{ITEMS}.length > 1")

    def choose(self, selector, beginning):
        """Chooses the first option whose text begins with `beginning`. Sends the event that a user's choice causes."""
        self.browser.run("""const list = document.querySelector(arguments[0]);
            const option = [...list.options].find((each) => each.textContent.startsWith(arguments[1]));
            list.value = option.value;
            list.dispatchEvent(new Event("change"));""", selector, beginning)

    def send(self, request):
        self.browser.run(f"""document.querySelector("{REQUEST}").value = arguments[0]""", request)
        self.browser.click(SEND)

    def replies(self, count):
        self.browser.until(f"{REPLIES}.length >= {count}")
        return self.browser.run(f"return {REPLIES}")

    def test_an_item_of_the_register_map_fills_in_a_request_and_the_console_decodes_the_reply(self):
        self.open("EX9042D-M@01", "EX9052D-M@02")
        self.choose(MODULE, "2 EX9052D-M at 02")
        self.browser.until(f"{ITEMS}.some((each) => each.startsWith('Read 0000–0007: inputs'))")
        self.choose(ITEM, "Read 0000–0007: inputs")
        self.assertEqual(self.browser.run(f"""return document.querySelector("{REQUEST}").value"""), "02 0000 0008")
        self.browser.click(SEND)
        self.assertIn("02 02 01 00 A1 CC from 0000: 0 0 0 0 0 0 0 0", self.replies(1)[0])
        self.assertRegex(self.replies(1)[0], r" \d+\.\d\d ms$")
        self.picture("console", whole=True)

    def test_a_coil_that_is_written_switches_its_output(self):
        self.open("EX9042D-M@01", "EX9052D-M@02")
        self.send("05 0003 FF00")
        self.browser.until(lit(8))
        self.send("05 0003 0000")
        self.browser.until(lit(0))

    def test_the_list_contains_the_dcon_commands_of_a_module_that_uses_ascii(self):
        self.open("EX9042D@0A")
        self.choose(ITEM, "$AAM")
        self.assertEqual(self.browser.run(f"""return document.querySelector("{REQUEST}").value"""), "$0AM")
        self.browser.click(SEND)
        self.assertIn("$0AM → !0A9042D\\r reply", self.replies(1)[0])

    def test_an_ascii_address_may_be_higher_than_the_highest_modbus_address(self):
        self.open("EX9042D@FF")
        self.send("$FFM")
        self.assertIn("$FFM → !FF9042D\\r reply", self.replies(1)[0])

    def test_a_checksum_is_added_if_the_module_expects_one(self):
        self.open("EX9042D@01,checksum=on")
        self.send("$01M")
        self.assertIn("$01MD2 → !019042D", self.replies(1)[0])

    def test_polling_repeats_a_request_and_a_later_request_gets_its_reply(self):
        self.open("EX9042D-M@01")
        self.choose(f"{FORM} select[aria-label^='Interval']", "0.2 s")
        self.browser.run(f"""document.querySelector("{REQUEST}").value = "01 0000 000D" """)
        self.browser.click(POLL)
        self.replies(3)
        self.browser.click(POLL)
        self.send("46 00")
        self.browser.until(f"{REPLIES}.some((each) => each.startsWith('46 00'))")

    def test_each_line_has_a_console_of_its_own(self):
        self.browser.open(self.bus(MANY).address)
        yard = "#consoles details:nth-child(2)"
        self.browser.until(f"document.querySelector('{yard}') !== null")
        self.browser.click(f"{yard} > summary")
        self.browser.until(f"document.querySelector('{yard} select').options.length === 33")
        self.browser.run(f"""document.querySelector("{yard} input[type=text]").value = "05 0000 FF00" """)
        self.browser.click(f"{yard} button")
        self.browser.until("document.querySelector('[aria-label=\"33 EX9042D-M\"] .output').dataset.on === 'true'")
        lamp = "document.querySelector('[aria-label=\"1 EX9042D-M\"] .output').dataset.on"
        self.assertEqual(self.browser.run(f"return {lamp}"), "false")

    def test_a_wrong_request_and_a_broadcast_are_reported(self):
        self.open("EX9042D-M@01")
        self.send("nonsense")
        self.assertIn("expected a DCON command", self.replies(1)[0])
        self.choose(MODULE, "all modules")
        self.send("05 0000 FF00")
        self.assertIn("sent to all modules", self.replies(2)[1])
        self.browser.until(lit(1))


if __name__ == "__main__":
    unittest.main()
