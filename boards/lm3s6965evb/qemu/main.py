"""Parses the arguments and passes bytes between the module and the pseudo-terminal."""

from __future__ import annotations

import argparse
import contextlib
import os
import select
import signal
import sys
from pathlib import Path

from qemu import eeprom, image
from qemu.machine import Ended, Machine
from qemu.pseudo_terminal import PseudoTerminal
from qemu.refusal import Refusal


def _arguments(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="run",
        description="Runs a firmware image in QEMU. The first line it prints is the pseudo-terminal that is the "
        "module's RS-485 line. Press Ctrl-C or send SIGTERM to end it.",
    )
    parser.add_argument("image", metavar="IMAGE.elf", type=Path, help="an image of the preset lm3s6965evb")
    parser.add_argument(
        "--link", metavar="PATH", type=Path, help="make a symbolic link to the pseudo-terminal"
    )
    parser.add_argument(
        "--eeprom",
        metavar="FILE",
        type=Path,
        help="keep the contents of the EEPROM in this file of 8192 bytes; create a missing file as a factory-fresh "
        "module",
    )
    parser.add_argument("--init", action="store_true", help="tie INIT* to GND: ASCII, address 00, 9600 baud")
    parser.add_argument("--gdb", metavar="PORT", type=int, help="let a debugger connect to 127.0.0.1:PORT")
    return parser.parse_args(words)


def main(words: list[str]) -> int:
    """Runs the program. Returns its exit status: 0 after a signal, 1 if QEMU has ended, 2 after a Refusal.

    Wrong options raise SystemExit with status 2.
    """
    arguments = _arguments(words)
    try:
        with contextlib.ExitStack() as at_the_end:
            signal_descriptor = _signal_descriptor()
            image.check(arguments.image)
            terminal = PseudoTerminal()
            if arguments.link:
                terminal.link(arguments.link)
                at_the_end.callback(terminal.unlink)
            memory = eeprom.in_file(arguments.eeprom) if arguments.eeprom else eeprom.in_memory()
            machine = Machine(arguments.image, memory, arguments.init, arguments.gdb)
            at_the_end.callback(machine.end)
            print(terminal.device)
            print(f"{arguments.image.name} runs in QEMU; press Ctrl-C to end", flush=True)
            _carry_bytes(machine, terminal, signal_descriptor)
    except Refusal as refusal:
        print(f"run: {refusal}", file=sys.stderr)
        return 2
    except Ended as ended:
        print(f"run: {ended}", file=sys.stderr)
        return 1
    return 0


def _signal_descriptor() -> int:
    """Returns a descriptor that becomes readable when SIGINT, SIGTERM or SIGHUP arrives."""
    readable, writable = os.pipe()
    os.set_blocking(writable, False)
    signal.set_wakeup_fd(writable)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:  # nohup ignores SIGHUP
            signal.signal(number, lambda *_: None)
    return readable


def _carry_bytes(machine: Machine, terminal: PseudoTerminal, signal_descriptor: int) -> None:
    """Passes bytes until a signal arrives. Neither side waits for the other, because a blocked UART stops QEMU."""
    while True:
        watched = [signal_descriptor, machine.events, terminal.open_events, machine.line]
        if terminal.is_opened():
            watched.append(terminal.master)
        ready, _, _ = select.select(watched, [], [], machine.send_queued_within)
        if signal_descriptor in ready:
            return
        if terminal.open_events in ready:
            terminal.process_open_events()
        if machine.events in ready:
            machine.take_events()
        if machine.line in ready:
            terminal.write(machine.receive_reply())
        requests = terminal.read()  # always, because a master may have written and closed the terminal
        if requests:
            machine.queue_request(requests)
        machine.send_queued()
