"""Tests the page of ex9000 panel, which shows the modules that it finds on a line."""

import pathlib
import signal
import subprocess
import unittest

from panel_page import INPUTS, OUTPUTS, Panel, lit, pressed, text
from simulator import HANG, PROGRAM, Simulator
from web_socket import Page

DI3 = "[aria-label='2 EX9052D-M: input DI3']"
ASCII = "[aria-label='3 EX9044D']"
DRAWER = f"{OUTPUTS} details"
REPLIES = "[...document.querySelectorAll('#consoles .replies > div')].map((each) => each.textContent)"
HIDDEN = """[".ways", ".controls", "#faultlines"].every((each) =>
    document.querySelector(each).getClientRects().length === 0)"""


class Utility:
    """A running ex9000 panel."""

    def __init__(self, port):
        self.process = subprocess.Popen(
            [pathlib.Path(PROGRAM).parent / "ex9000", "panel", f"tcp:127.0.0.1:{port}", "--addresses", "1-3",
             "--timeout", "2s"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        for line in self.process.stdout:
            if line.startswith("panel: "):
                self.address = line.split()[1]
                return
        raise AssertionError("ex9000 panel has found no modules")

    def end(self):
        """Ends it as Ctrl-C does. Returns its exit status."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(HANG)

    def close(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()


class RealLine(Panel):
    def setUp(self):
        super().setUp()
        simulator = Simulator("EX9042D-M@01,name=PUMPS", "EX9052D-M@02", "EX9044D@03,checksum=on", "--port", "tcp:0")
        self.addCleanup(simulator.close)
        self.plant = Page(simulator.port)
        self.addCleanup(self.plant.close)
        self.utility = Utility(simulator.lines[0])
        self.addCleanup(self.utility.close)
        self.look_at(self.utility)

    def act(self, command):
        self.assertTrue(self.plant.tell(command)["ok"])

    def test_the_page_shows_modules_of_a_real_line_and_sends_requests(self):
        self.browser.until(text(OUTPUTS, ".name", "PUMPS"))
        self.assertTrue(self.browser.run(f"return {HIDDEN}"))
        self.browser.until(text(ASCII, ".readouts", "ASCII+Σ"))

        self.browser.click(f"{DRAWER} > summary")
        self.browser.until(f"""document.querySelector("{DRAWER}").textContent.includes("watchdog-timeout")""")

        self.act("2 input 3 on")
        self.browser.until(pressed(DI3))
        self.act("2 input 3 off")
        self.browser.until(f"!({pressed(DI3)}) && {text(INPUTS, 'li:nth-child(4) .count', '1')}")

        self.browser.click("#consoles summary")
        self.browser.run("""document.querySelector("#consoles input[type=text]").value = "05 0003 FF00" """)
        self.browser.click("#consoles input[type=checkbox]")  # again and again
        self.browser.until(lit(8))
        self.browser.until(f"{REPLIES}.some((each) => each.startsWith('05 0003 FF00 → 01 05 00 03 FF 00 7C 3A'))")
        self.browser.until("""[...document.querySelectorAll("#filler .row")].some((row) =>
            row.textContent.includes("1 EX9042D-M"))""")

        self.picture("real-line", whole=True)
        self.assertEqual(self.utility.end(), 0)

    def test_a_module_that_does_not_reply_is_shown_as_such_until_it_replies_again(self):
        self.act("1 power off")
        self.browser.until(text(OUTPUTS, ".ledtext", "no reply"))
        self.assertTrue(self.browser.run(f"return {text(OUTPUTS, '.readouts', '01')}"))
        self.act("1 power on")
        self.browser.until(text(OUTPUTS, ".ledtext", "on"))


if __name__ == "__main__":
    unittest.main()
