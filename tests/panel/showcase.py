"""The picture of the panel in the documents: two modules after some requests, with a request in the console. The file
contains the texts that the page showed, so that a test can find out whether the picture is out of date."""

import json
import pathlib
import struct
import zlib

from panel_page import DI3, INPUTS, lit, pressed, text
from simulator import Master

PICTURE = pathlib.Path(__file__).resolve().parents[2] / "sim/front_ends/panel/screenshot.png"
SIZE = (1060, 900)
CONSOLE = "#consoles details"
SIGNATURE = b"\x89PNG\r\n\x1a\n"
KEYWORD = b"Texts\0\0\0\0\0"  # keyword, not compressed, no language

# The fixed texts of the page, each once. Values, and texts that depend on the machine, are not among them.
TEXTS = """
  const fixed = "h1, h2, h3, nav a, legend, fieldset label, .bar label, button, summary, .hint, [role=columnheader], " +
    ".channels .label, .readout .label, .control > span, .edge li";
  const texts = [...document.querySelectorAll(fixed)].map((each) => each.textContent.replace(/\\s+/g, " ").trim());
  return [...new Set(texts)].filter((each) => each !== "").sort();
"""


def prepare(browser, simulator):
    """Lets a page that shows an EX9042D-M at 01 and an EX9052D-M at 02 show some traffic and a reply in the console.
    Returns the texts of the page."""
    master = Master(simulator.lines[0])
    try:
        master.ask("010601E800C8", 8)
        master.coil(1, 0x0104, True)  # enables the host watchdog with a timeout of 20 s
        for coil in 0, 2, 4, 6, 8, 10:
            master.coil(1, coil, True)
        browser.until(lit(0b101_0101_0101))
        browser.click(DI3)
        browser.until(pressed(DI3))
        browser.until(text(INPUTS, "li:nth-child(4) .latch", "H"))
        for register in range(4):
            master.counter(2, register)
            master.ask("020200000008", 6)
    finally:
        master.close()
    browser.click(f"{CONSOLE} > summary")
    browser.until(f"""document.querySelector("{CONSOLE} select[aria-label^='Item']").options.length > 1""")
    browser.run(f"""document.querySelector("{CONSOLE} input[type=text]").value = "01 0000 000D" """)
    browser.click(f"{CONSOLE} button")
    browser.until(f"""document.querySelectorAll("{CONSOLE} .replies > div").length === 1""")
    return browser.run(TEXTS)


def chunks(png):
    """Returns the type and the data of each chunk of a PNG file."""
    assert png.startswith(SIGNATURE)
    found, at = [], len(SIGNATURE)
    while at < len(png):
        size, = struct.unpack(">I", png[at:at + 4])
        found.append((png[at + 4:at + 8], png[at + 8:at + 8 + size]))
        at += 12 + size
    return found


def with_texts(png, texts):
    """Returns the PNG file with the texts before its last chunk."""
    *first, last = chunks(png)
    added = (b"iTXt", KEYWORD + json.dumps(texts, ensure_ascii=False).encode())
    return SIGNATURE + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in (*first, added, last))


def texts_in(png):
    """Returns the texts in the PNG file."""
    for kind, data in chunks(png):
        if kind == b"iTXt" and data.startswith(KEYWORD):
            return json.loads(data[len(KEYWORD):])
    raise AssertionError(f"{PICTURE}: contains no texts; make it with tests/panel/screenshot")
