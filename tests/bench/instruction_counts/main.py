"""The command line."""

import argparse
import collections
import concurrent.futures
import os
import sys

from instruction_counts import execution
from instruction_counts.capacity import Found, capacity
from instruction_counts.emulator import ROOT, die_with_parent
from instruction_counts.requests import Model
from instruction_counts.session import Session

OUTPUTS = Model("EX9042D-M", 0, 13, True)
INPUTS = Model("EX9052D-M", 8, 0, True)
BOTH = Model("EX9055D", 8, 8, False)

# Model, ASCII, and whether what all models have is asked too: once in each protocol, where it costs most,
# which is where there are inputs.
SESSIONS = [
    (INPUTS, False, True),
    (BOTH, True, True),
    (OUTPUTS, False, False),
    (OUTPUTS, True, False),
    (INPUTS, True, False),
]

BYTE_LIMIT = 100
LATE_BYTE_LIMIT = 200  # two interrupts' work in one: a byte's and a silence's
EDGE_LIMIT = 100
EDGE_PASSES = 20  # for each of eight inputs

# The highest pass has served so many, and its count is shared among them.
Row = collections.namedtuple("Row", "name highest served limit until")


def rows_of(counter):
    rows = [
        Row(request.name, highest, 1, request.limit, request.until)
        for request, highest in counter.requests.items()
    ]

    def add(name, highest, served=1, limit=None):
        rows.append(Row(name, highest, served, limit, ""))

    add("received byte", counter.received_byte, limit=BYTE_LIMIT)
    if counter.late_byte.passes:
        add("received byte that ends the frame before it", counter.late_byte, limit=LATE_BYTE_LIMIT)
    for edges, highest in sorted(counter.edges.items()):
        add("input edge" if edges == 1 else f"input edge, {edges} at once", highest, edges, EDGE_LIMIT)
    add("sent byte", counter.sent_byte)
    names = {
        execution.TICK: "tick's interrupt",
        execution.SILENCE: "silence's interrupt",
        execution.I2C: "I2C's interrupt",
        execution.LINE_END: "interrupt at the reply's end",
    }
    for exception, highest in sorted(counter.interrupts.items()):
        add(names.get(exception, f"exception {exception}"), highest)
    add("tick's turn of the main loop", counter.ticks_turn)
    add("idle turn of the main loop", counter.idle_turn)
    return rows


def count_of(row):
    return -(-row.highest.count // row.served)


def is_over(row):
    return row.limit is not None and (count_of(row) > row.limit or row.highest.passes < row.highest.wanted)


def run_session(options, model, is_ascii, general):
    """Returns the text to print, the names of what is over its limit, and what `capacity` wants."""
    label = f"{model.name} {'ASCII' if is_ascii else 'RTU'}"
    everything = not options.only
    with Session(os.path.join(options.folder, f"{model.name}.elf"), options.gate, model, is_ascii) as session:
        session.set_up()
        session.count_requests(
            general or options.all, lambda request: options.only in f"{label} {request.name}", options.passes
        )
        if everything:
            session.count_ticks()
            if not is_ascii:
                session.count_late_bytes()
            if model.inputs:
                session.count_edges(EDGE_PASSES)
    rows = [
        row._replace(name=f"{label} {row.name}")
        for row in rows_of(session.counter)
        if everything or row.highest.passes
    ]
    lines = [text_of(row) for row in rows]
    if options.profile:
        lines += [profile(session.image, row) for row in rows if options.profile in row.name]
    if options.verbose:
        lines.append(f"{label}: {session.counter.spoiled} passes into which something else came")
    found = Found()
    found.add(session.counter)
    return lines, [row.name for row in rows if is_over(row)], found


def text_of(row):
    limit = "" if row.limit is None else f"of {row.limit}"
    mark = "OVER" if is_over(row) else ""
    ahead = f", {row.highest.ahead} ahead" if row.highest.ahead else ""
    passes = f"{row.highest.passes:6} passes {row.until}{ahead}"
    return f"{row.name:58} {count_of(row):5} {limit:7} {mark:4} {passes}".rstrip()


def profile(image, row):
    addresses = [int(address, 16) for address in row.highest.addresses]
    chains = image.inlined(addresses)
    text = [f"\n{row.name}: {len(addresses)} instructions"]
    for title, names in (
        ("by function of the image", map(image.function, addresses)),
        ("by function of the source", (chains[address][0] for address in addresses)),
    ):
        text.append(f"  {title}")
        text += [f"{amount:8} {function}" for function, amount in collections.Counter(names).most_common()]
    return "\n".join(text) + "\n"


def main(arguments):
    parser = argparse.ArgumentParser(
        prog="instructions",
        description="Counts the instructions that firmware images execute in QEMU, the highest of 100 passes each, and "
        "holds them to limits: for a request from the interrupt that ends the silence behind it to the first byte of "
        "the reply, or to the begin of the write to the EEPROM; what was done ahead, while the silence lasted, is told "
        "apart. Exit status 1 where a limit is passed.",
    )
    parser.add_argument("folder", help="with the images for lm3s6965evb, as ELF files")
    parser.add_argument(
        "--only", default="", metavar="TEXT", help="requests whose names hold it, and nothing else"
    )
    parser.add_argument(
        "--profile", default="", metavar="TEXT", help="by function, what the highest pass has executed"
    )
    parser.add_argument("--passes", type=int, default=100)
    parser.add_argument(
        "--gate",
        default=os.path.join(ROOT, "build/host-debug/tests/qemu/libex9000_gate.so"),
        metavar="FILE",
        help="tests/qemu/gate.cpp, as a preset for the host builds it; of host-debug if left out",
    )
    parser.add_argument("--all", action="store_true", help="every request on every model that has it")
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1, help="sessions at a time"
    )
    parser.add_argument("--verbose", action="store_true", help="say how many passes did not count")
    options = parser.parse_args(arguments)
    over = []
    found = Found()
    with concurrent.futures.ProcessPoolExecutor(options.jobs, initializer=die_with_parent) as pool:
        for session in [pool.submit(run_session, options, *session) for session in SESSIONS]:
            lines, names, its = session.result()
            over += names
            found.merge(its)
            if lines:
                print("\n".join(lines), flush=True)
    if not options.only:
        print(capacity(found))
    if over:
        print("over the limit, or not counted often enough: " + "; ".join(over), file=sys.stderr)
    return 1 if over else 0
