"""Tests the bus in the browser: the list of frames, pause, search, the strip, and faults."""

import unittest

from panel_page import Panel, pressed
from simulator import Master, repeating, wait_until
from web_socket import Page

# The number of rows in the document, except rows of notes. The document contains rows only for the visible entries of
# the list and for some entries above and below them. A note reports, for example, a delay of the host.
ROWS = "document.querySelectorAll('#filler .row:not([data-kind=note])').length"
TALLY = "document.getElementById('tally').textContent"
PAUSED = "document.getElementById('pause').getAttribute('aria-pressed') === 'true'"
LOST = "document.getElementById('lost').textContent.includes('trying again')"
PICTURE = "document.getElementById('canvas').toDataURL()"
# A JavaScript function that returns whether pixel row `y` of the strip contains the colour `name`.
PAINTED = """((name, y) => {
  const strip = document.getElementById('canvas');
  const copy = document.createElement('canvas');
  copy.width = strip.width;
  const pen = copy.getContext('2d', {willReadFrequently: true});
  pen.fillStyle = getComputedStyle(document.documentElement).getPropertyValue('--' + name);
  pen.fillRect(0, 0, 1, 1);
  const wanted = pen.getImageData(0, 0, 1, 1).data.join();
  pen.clearRect(0, 0, copy.width, 1);
  pen.drawImage(strip, 0, y, strip.width, 1, 0, 0, strip.width, 1);
  const row = pen.getImageData(0, 0, copy.width, 1).data;
  for (let at = 0; at < row.length; at += 4) {
    if (row.slice(at, at + 4).join() === wanted) { return true; }
  }
  return false;
})"""


def entries_of(message):
    return [entry for line in message.get("frames", ()) for entry in line["entries"]]


class Bus(Panel):
    def ask_inputs(self, master, times):
        for _ in range(times):
            master.ask("020200000008", 6)

    def asking_inputs(self, master):
        """Repeats requests while the `with` block runs, because the strip shows only the last second."""
        return repeating(lambda: self.ask_inputs(master, 1))

    def faults_of(self, simulator):
        page = Page(simulator.port)
        state = page.until(lambda message: "hello" in message)["state"]
        page.close()
        return state["lines"][0]["faults"]

    def type(self, selector, words):
        self.browser.run(f"""const field = document.querySelector("{selector}"); field.value = "{words}";
            field.dispatchEvent(new Event('input'))""")

    def test_a_paused_page_counts_new_frames_and_shows_them_later(self):
        _, master = self.show_two()
        self.ask_inputs(master, 2)
        self.browser.until(f"{TALLY} === '4 frames'")
        self.browser.click("#pause")
        self.ask_inputs(master, 3)
        self.browser.until(f"{TALLY} === '4 frames, 6 more'")
        self.assertEqual(self.browser.run(f"return {ROWS}"), 4)
        self.browser.click("#pause")
        self.browser.until(f"{TALLY} === '10 frames' && {ROWS} === 10")

    def test_a_search_works_while_the_page_is_paused(self):
        _, master = self.show_two()
        master.coil(1, 2, True)
        master.counter(2, 0)
        self.browser.until(f"{ROWS} === 4")
        self.browser.click("#pause")
        self.type("#search", "coil 0002")
        self.browser.until(f"{ROWS} === 1 && {TALLY} === '1 of 4'")
        row = self.browser.run("return document.querySelector('#filler .row:not([data-kind=note])').textContent")
        self.assertIn("01 05 00 02 FF 00", row)
        master.coil(1, 2, False)
        self.browser.until(f"{TALLY} === '1 of 4, 2 more'")
        self.browser.click("#pause")
        self.browser.until(f"{ROWS} === 2 && {TALLY} === '2 of 6'")
        self.type("#search", "")
        self.browser.until(f"{ROWS} === 6")
        self.browser.run("document.getElementById('bus').scrollIntoView()")
        self.picture("bus")

    def test_after_a_pause_the_page_shows_for_each_line_the_number_of_omitted_rows(self):
        modules = [{"model": "EX9052D-M", "address": "02"}]
        simulator = self.bus([{"name": name, "port": "tcp:0", "timing": "instant", "modules": modules}
                              for name in ("hall", "yard")])
        self.look_at(simulator)
        masters = [Master(port) for port in simulator.lines]
        for master in masters:
            self.addCleanup(master.close)
            self.ask_inputs(master, 1)
        self.browser.until(f"{ROWS} === 4")
        self.browser.click("#pause")
        for _ in range(1500):
            for master in masters:
                self.ask_inputs(master, 1)
        self.browser.until(f"{TALLY} === '4 frames, 6000 more'")
        self.browser.click("#pause")
        self.browser.until(f"!{TALLY}.includes('more')")
        self.type("#search", "left out")
        left_out = """[...document.querySelectorAll('.row[data-kind=missed]')].map((row) =>
            row.querySelector('.from').textContent + ': ' + row.querySelector('.meaning').textContent)"""
        for name in "hall", "yard":
            self.browser.until(f"{left_out}.some((said) => /^{name}: [0-9]+ rows were left out here$/.test(said))")
        self.picture("left-out")

    def test_a_paused_page_counts_the_omitted_notes_of_a_line_without_frames(self):
        self.show("EX9052D-M@02")
        rows = self.browser.promised("""
            const {Timeline} = await import("/timeline.js");
            const timeline = new Timeline();
            timeline.begin([{name: "hall"}, {name: "yard"}], (line) => ["hall", "yard"][line], () => 0);
            timeline.setPaused(true);
            const frame = (number) => ({number, station: 0, bytes: "00", began: number, ended: number});
            timeline.add([
              {line: 1, entries: [{number: 0, note: "the host was late", began: 0}]},
              {line: 0, entries: [...Array(1300).keys()].map(frame)},
            ]);
            timeline.setPaused(false);
            timeline.tell();
            return timeline.entries.filter(({missed}) => missed).map(({from, means}) => `${from}: ${means}`);""")
        self.assertEqual(sorted(rows), ["hall: 300 rows were left out here", "yard: 1 row was left out here"])

    def test_if_the_simulator_starts_again_a_paused_page_resumes_and_shows_the_new_modules(self):
        simulator, master = self.show_two()
        self.ask_inputs(master, 1)
        self.browser.until(f"{TALLY} === '2 frames'")
        self.browser.click("#pause")
        self.ask_inputs(master, 1)
        self.browser.until(f"{TALLY} === '2 frames, 2 more'")
        simulator.kill()
        self.browser.until(LOST)
        simulator.start_again("EX9055D@02", "EX9063D@03", "EX9042D@04", "--port", "tcp:0")
        self.browser.until(f"!({LOST})")
        self.browser.until(f"!({PAUSED}) && {TALLY} === '0 frames' && {ROWS} === 0")
        models = "return [...document.querySelectorAll('.plate h3')].map((each) => each.textContent)"
        self.assertEqual(self.browser.run(models), ["EX9055D", "EX9063D", "EX9042D"])
        again = Master(simulator.lines[0])
        self.addCleanup(again.close)
        self.assertEqual(again.say("$02M"), "!029055")
        self.browser.until(f"{TALLY} === '2 frames' && {ROWS} === 2")
        with repeating(lambda: again.say("$02M")):
            self.browser.until(f"{PAINTED}('master', 20) && {PAINTED}('module', 30)")

    def test_the_strip_moves_while_it_shows_only_notes(self):
        simulator = self.show("EX9042D")
        page = Page(simulator.port)
        self.addCleanup(page.close)
        self.assertTrue(page.tell("1 fault hang every 100ms")["ok"])
        self.browser.until(f"{PAINTED}('note', 26) && {TALLY} === '0 frames'")
        self.assertTrue(page.tell("fault off 1")["ok"])
        self.browser.until(f"!{PAINTED}('note', 26)")  # the notes have moved out of the strip

    def test_a_late_frame_is_sorted_by_its_time(self):
        simulator = self.show("EX9042D@01,baud=1200", "--baud", "1200")
        page = Page(simulator.port)
        self.addCleanup(page.close)
        master = Master(simulator.lines[0])
        self.addCleanup(master.close)
        error = "document.querySelector('.row[data-kind=error]')"
        # The frame takes 0.33 s. In this time the simulator writes notes, and the page receives them before the frame.
        page.say("1 fault hang every 50ms")
        master.send(bytes([7] * 40))
        pause = "(document.getElementById('pause').click(), true)"  # otherwise notes move the frame out of sight
        self.browser.until(f"{error} !== null && {PAINTED}('bad', 20) && {PAINTED}('note', 46) && {pause}")
        in_turn = """const rows = [...document.querySelectorAll('#filler .row')];
            rows.sort((a, b) => a.ariaRowIndex - b.ariaRowIndex);
            return rows.map((row) => Number(row.querySelector('.time').textContent))"""
        times = self.browser.run(in_turn)
        self.assertEqual(times, sorted(times))
        heard = []
        page.until(lambda message: heard.extend(entries_of(message)) or any("error" in each for each in heard))
        late = next(each for each in heard if "error" in each)
        notes = [f"{each['began'] / 1e6:.6f}" for each in heard[: heard.index(late)] if each["began"] > late["began"]]
        self.assertTrue(notes)  # these notes began after the frame began, and the page received them before the frame
        after = """const rows = [...document.querySelectorAll('#filler .row')];
            return rows.slice(rows.findIndex((row) => row.dataset.kind === 'error') + 1)
              .map((row) => row.querySelector('.time').textContent)"""
        self.assertIn(notes[0], self.browser.run(after))

    def test_every_line_has_a_lane(self):
        lines = [{"name": f"line{n}", "port": "tcp:0", "modules": ["EX9052D-M@02"]} for n in range(9)]
        simulator = self.bus(lines)
        self.look_at(simulator)
        self.assertIn("9 lines", self.browser.run("return document.getElementById('about').textContent"))
        names = self.browser.run("return [...document.querySelectorAll('.linename')].map((each) => each.textContent)")
        self.assertEqual(names, [f"line{n} 127.0.0.1:{port}" for n, port in enumerate(simulator.lines)])
        master = Master(simulator.lines[8])
        self.addCleanup(master.close)
        self.browser.run("document.getElementById('lanes').scrollTop = 10000")
        with self.asking_inputs(master):
            self.browser.until(f"{PAINTED}('master', 8 * 52 + 20) && {PAINTED}('module', 8 * 52 + 30)")
            self.browser.run("document.getElementById('bus').scrollIntoView()")
            self.picture("nine-lines")
        self.browser.run("document.getElementById('lanes').scrollTop = 0")
        self.browser.until(f"!{PAINTED}('master', 8 * 52 + 20)")

    def test_arrow_keys_and_dragging_move_a_paused_strip(self):
        _, master = self.show_two()
        with self.asking_inputs(master):  # so that the strip shows different frames after each move
            self.browser.until(f"{ROWS} > 20 && {PAINTED}('master', 20)")
            self.browser.click("#pause")
        self.browser.run("document.getElementById('canvas').focus()")
        for move in (lambda: self.browser.key("Left"), lambda: self.browser.drag("#canvas", 200),
                     lambda: self.browser.drag("#canvas", -100), lambda: self.browser.key("Right")):
            self.browser.run(f"window.before = {PICTURE}")
            move()
            self.browser.until(f"{PICTURE} !== before")
        label = "document.getElementById('canvas').ariaLabel"
        self.browser.until(f"{label} === 'An earlier period of 1000 ms on 1 line'")
        self.browser.click("#pause")
        self.browser.until(f"{label} === 'The last 1000 ms on 1 line'")

    def test_each_of_several_fast_clicks_switches_the_fault(self):
        simulator, _ = self.show_two()
        noise = "[aria-label='Fault inserted-bytes 0.01']"
        click = f"""document.querySelector("{noise}").click();"""
        self.browser.run(click * 3)
        wait_until(lambda: [fault["number"] for fault in self.faults_of(simulator)] == [2])  # on, off, and on again
        self.browser.until(f"{pressed(noise)}")
        self.browser.run(click)
        self.browser.until(f"!({pressed(noise)})")
        self.assertEqual(self.faults_of(simulator), [])

    def test_a_fault_of_one_module_is_switched_on_and_off(self):
        simulator, _ = self.show_two()
        self.browser.type("[aria-label='Target of the fault']", "2")
        self.browser.type("[aria-label='Another fault']", "late-reply 50ms\ue007")
        fault = "[aria-label='Fault module 2: late-reply 50ms']"
        self.browser.until(pressed(fault))
        faults = [(each["module"], each["text"]) for each in self.faults_of(simulator)]
        self.assertEqual(faults, [(1, "late-reply 50ms")])
        self.browser.run(f"""document.querySelector("{fault}").click()""")
        self.browser.until(f"!({pressed(fault)})")
        self.assertEqual(self.faults_of(simulator), [])


if __name__ == "__main__":
    unittest.main()
