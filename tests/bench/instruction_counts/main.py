"""The command line of tests/bench/instructions."""

import argparse
import collections
import concurrent.futures
import multiprocessing
import os
import sys

from instruction_counts import execution
from instruction_counts.capacity import Found, capacity
from instruction_counts.emulator import ROOT, Emulator, die_with_parent
from instruction_counts.refusal import Refusal
from instruction_counts.requests import Model
from instruction_counts.session import REST, Session

RECORD = ROOT / "tests/bench/recorded_instructions"

OUTPUTS = Model("EX9042D-M", 0, 13, True)
INPUTS = Model("EX9052D-M", 8, 0, True)
BOTH = Model("EX9055D", 8, 8, False)

# For each session: the model, whether the session uses ASCII, and whether it also sends the requests that are the same
# for all models. Only one session of each protocol sends those requests. The models of these sessions have inputs,
# because those requests require the most instructions on a model with inputs.
SESSIONS = [
    (INPUTS, False, True),
    (BOTH, True, True),
    (OUTPUTS, False, False),
    (OUTPUTS, True, False),
    (INPUTS, True, False),
]

EDGE_PASSES = 20  # for each input and for each group of inputs
GROWTH = 1.05  # a count above this multiple of the recorded count is an error

# A row of the result. `passes`: a counter.Highest, counter.Median or counter.Sum. `served`: the number of edges or
# milliseconds to which the count of `passes` belongs; 1 in all other rows. The tool divides the count by `served`.
# `until`: how the request ends (requests.py); empty if the row is not for a request.
Row = collections.namedtuple("Row", "name passes served until")


def rows_of(counter):
    """Returns the rows of a counter."""
    rows = [Row(request.name, passes, 1, request.until) for request, passes in counter.requests.items()]

    def add(name, passes, served=1):
        rows.append(Row(name, passes, served, ""))

    add("received byte", counter.received_byte)
    for edges, highest in sorted(counter.edges.items()):
        add("edge with a filter" if edges == 1 else f"edge with a filter, {edges} at once", highest, edges)
    add("sent byte", counter.sent_byte)
    names = {
        execution.TICK: "tick's interrupt",
        execution.SILENCE: "silence's interrupt",
        execution.I2C: "I2C's interrupt",
        execution.LINE_END: "interrupt at the reply's end",
        execution.WAKE: "wake timer's interrupt",
    }
    for exception, highest in sorted(counter.interrupts.items()):
        add(names.get(exception, f"exception {exception}"), highest)
    add("tick's turn of the main loop", counter.ticks_turn)
    add("a millisecond at rest", counter.idling, round(REST * 1000))
    return rows


def count_of(row):
    return -(-row.passes.count // row.served)


def image_of(options, model):
    return os.path.join(options.folder, f"{model.name}.elf")


def run_session(options, model, is_ascii, general):
    """Returns the rows to print, and the input for `capacity`."""
    label = f"{model.name} {'ASCII' if is_ascii else 'RTU'}"
    everything = not options.only
    with Session(image_of(options, model), options.gate, model, is_ascii) as session:
        session.set_up()
        session.count_requests(
            general, lambda request: options.only in f"{label} {request.name}", options.passes
        )
        if everything:
            session.count_rest()
            if model.inputs:
                session.count_edges(EDGE_PASSES)
    rows = [
        row._replace(name=f"{label} {row.name}")
        for row in rows_of(session.counter)
        if everything or row.until and row.passes.passes
    ]
    found = Found()
    found.add(session.counter)
    return [(row.name, count_of(row), row.until) for row in rows], found


def results(options):
    """Runs all sessions, and yields the result of each in the order of SESSIONS. If a session raises an exception, ends
    the other sessions and raises this exception."""
    with concurrent.futures.ProcessPoolExecutor(options.jobs, initializer=die_with_parent) as pool:
        sessions = [pool.submit(run_session, options, *session) for session in SESSIONS]
        try:
            for finished in concurrent.futures.as_completed(list(sessions)):
                finished.result()
                while sessions and sessions[0].done():
                    yield sessions.pop(0).result()
        except BaseException:
            for process in multiprocessing.active_children():
                process.kill()
            raise


def recorded(record):
    lines = record.read_text().splitlines() if record.exists() else []
    return {name: int(count) for name, count in (line.rsplit(" ", 1) for line in lines)}


def text_of(name, count, until, before):
    since = "new" if before is None else f"{count - before:+}" if count != before else ""
    return f"{name:58} {count:6} {since:6} {until}".rstrip()


def main(arguments):
    parser = argparse.ArgumentParser(
        prog="instructions",
        description="Counts the instructions that firmware images execute in an emulator for whole transactions. A "
        "transaction starts at the first received byte. It ends when the main loop sleeps and, after a reply, the "
        "driver enable is off. The count includes all interrupts and the main loop, but not the tick. The result is "
        "the median of the passes (see --passes). The tool also counts the instructions of single interrupts, of the "
        "tick's turn of the main loop, and of a millisecond at rest. For interrupts and for that turn, the result is "
        "the highest count. The tool also prints the difference from the record. Without --record, the exit status is "
        "1 if a count has grown by more than 5 % since it was recorded. It is 2 if a file or a program is missing or "
        "fails.",
    )
    parser.add_argument("folder", help="folder with the images, as ELF files")
    parser.add_argument(
        "--only", default="", metavar="TEXT", help="count only requests whose names contain TEXT"
    )
    parser.add_argument(
        "--passes", type=int, default=100, help="maximum number of passes of each request (default: 100)"
    )
    parser.add_argument(
        "--gate",
        default=os.path.join(ROOT, "build/host-debug/tests/qemu/libex9000_gate.so"),
        metavar="FILE",
        help="the plugin that a preset for the host builds from tests/qemu/gate.cpp (default preset: host-debug)",
    )
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1,
        help="number of concurrent sessions (default: number of processors)"
    )
    parser.add_argument("--record", action="store_true", help="write the counts to the record")
    options = parser.parse_args(arguments)
    if options.record and options.only:
        parser.error("--record: the record must not depend on --only; omit this option")
    before = recorded(RECORD)
    counts = {}
    found = Found()
    try:
        for model, _, _ in SESSIONS:
            Emulator.check(image_of(options, model), options.gate)
        for rows, its in results(options):
            counts |= {name: count for name, count, _ in rows}
            found.merge(its)
            for name, count, until in rows:
                print(text_of(name, count, until, before.get(name)))
            sys.stdout.flush()
    except (Refusal, RuntimeError) as error:
        print(f"instructions: {error}", file=sys.stderr)
        return 2
    if not options.only:
        print(capacity(found))
    if options.record:
        RECORD.write_text("".join(f"{name} {count}\n" for name, count in counts.items()))
        return 0
    grown = [name for name, count in counts.items() if name in before and count > GROWTH * before[name]]
    if grown:
        print(f"{'; '.join(grown)}: grown by more than 5 %; if this is intended, repeat the command with --record and "
              "without --only", file=sys.stderr)
    return 1 if grown else 0
